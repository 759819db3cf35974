"""A peer that sends random messages: random fields, or plausible ones that contradict each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import Dialect
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from random import Random

    from mavstack.dialects import Message
    from mavstack.services import Address

COMMON = Dialect.load("common")
#: Fields that are indexes or counts; small values refer to items that exist.
INDEX_FIELDS = {
    "seq",
    "count",
    "mission_type",
    "param_index",
    "param_count",
    "num_logs",
    "id",
    "last_log_num",
}


class RandomPeer:
    """A sender of packets from any source to one target."""

    def __init__(self, random: Random, target: Address) -> None:
        self.random = random
        self.target = target
        self._encoders: dict[Address, Encoder] = {}

    def packet(self, message: Message, source: Address) -> bytes:
        encoder = self._encoders.get(source)
        if encoder is None:
            encoder = self._encoders[source] = Encoder(*source)
        return encoder.encode(message)

    def random_packet(self, message_id: int, source: Address) -> bytes:
        """Return a packet with random fields, mostly with a plausible target and plausible indexes."""
        kind = COMMON[message_id]
        message = kind.from_payload(self.random.randbytes(255))
        if self.random.random() < 0.8:
            for name in message.__match_args__:
                self._make_plausible(message, name)
        return self.packet(message, source)

    def _make_plausible(self, message: Message, name: str) -> None:
        if name == "target_system":
            message.target_system = self.target.system
        elif name == "target_component":
            message.target_component = self.target.component
        elif name in INDEX_FIELDS and self.random.random() < 0.8:
            setattr(message, name, self.random.choice([0, 0, 1, 2, 3, 5, 9]))
