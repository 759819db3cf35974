"""A peer that answers everything with anything: random fields, or plausible ones that contradict."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import Dialect
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from random import Random

    from mavstack.dialects import Message
    from mavstack.services import Address

COMMON = Dialect.load("common")
#: Fields that are looked up by number: with small values they hit what there is.
NUMBERS = {"seq", "count", "mission_type", "param_index", "param_count", "num_logs", "id", "last_log_num"}


class Peer:
    """Makes packets from any source to one victim."""

    def __init__(self, random: Random, victim: Address) -> None:
        self.random = random
        self.victim = victim
        self._encoders: dict[Address, Encoder] = {}

    def packet(self, message: Message, source: Address) -> bytes:
        encoder = self._encoders.get(source)
        if encoder is None:
            encoder = self._encoders[source] = Encoder(*source)
        return encoder.encode(message)

    def anything(self, message_id: int, source: Address) -> bytes:
        """A message of that id: nonsense, but mostly addressed and numbered so that it is believed."""
        kind = COMMON[message_id]
        message = kind.from_payload(self.random.randbytes(255))
        if self.random.random() < 0.8:
            for name in message.__match_args__:
                self._make_plausible(message, name)
        return self.packet(message, source)

    def _make_plausible(self, message: Message, name: str) -> None:
        if name == "target_system":
            message.target_system = self.victim.system
        elif name == "target_component":
            message.target_component = self.victim.component
        elif name in NUMBERS and self.random.random() < 0.8:
            setattr(message, name, self.random.choice([0, 0, 1, 2, 3, 5, 9]))
