"""What the engine keeps for each channel: a parser, an encoder a local component, signing and pace."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.pacing import Pacer
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack._core import HasCoreDialect
    from mavstack.dialects import Message
    from mavstack.services import Address, Priority
    from mavstack.wire import Packet, Signing


class ChannelState:
    """One channel as the engine sees it; sequence numbers count per channel and local component."""

    def __init__(
        self,
        name: str,
        dialect: HasCoreDialect,
        *,
        version: int = 2,
        signing: Signing | None = None,
        bandwidth: float | None = None,
        half_duplex: bool = False,
    ) -> None:
        self.name = name
        self.pacer = Pacer(bandwidth, half_duplex=half_duplex)
        self.unsendable = 0  # messages that this MAVLink version cannot carry
        self._dialect = dialect
        self._version = version
        self._signing = signing
        self._parser = Parser(dialect, signing=signing)
        self._encoders: dict[Address, Encoder] = {}

    @property
    def parser(self) -> Parser:
        """Its statistics tell what was heard and lost."""
        return self._parser

    @property
    def signing(self) -> Signing | None:
        """The signing state shared by both directions; setting it begins a new parser."""
        return self._signing

    @signing.setter
    def signing(self, signing: Signing | None) -> None:
        self._signing = signing
        self._parser = Parser(self._dialect, signing=signing)
        sequences = {source: encoder.sequence for source, encoder in self._encoders.items()}
        self._encoders.clear()
        for source, sequence in sequences.items():
            self._encoder(source).sequence = sequence

    def receive(self, data: bytes, now: float) -> list[Packet]:
        """The packets that the bytes complete."""
        self.pacer.received(len(data), now)
        return self._parser.feed(data, now)

    def encode(self, message: Message, source: Address, now: float, priority: Priority) -> bytes:
        """The packet to hand to the channel; counts as sent. Raises EncodeError if its version cannot."""
        data = self._encoder(source).encode(message, now)
        self.pacer.sent(len(data), now, priority)
        return data

    def _encoder(self, source: Address) -> Encoder:
        encoder = self._encoders.get(source)
        if encoder is None:
            encoder = Encoder(source.system, source.component, version=self._version, signing=self._signing)
            self._encoders[source] = encoder
        return encoder
