"""What the engine keeps for each channel: a parser, an encoder a local component, signing and pace."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.pacing import Pacer
from mavstack.security.timestamps import time_if_set
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
        bulk_rate: float | None = None,
    ) -> None:
        self.name = name
        #: Whether signing keys may be set over it: a cable, not a radio.
        self.trusted = False
        self.link_id = 0  # what it signs as: signatures tell channels apart by it
        self.pacer = Pacer(bandwidth, half_duplex=half_duplex, bulk_rate=bulk_rate)
        self.thinned = 0  # messages of streams for which there was no room
        self.unsendable = 0  # messages that this MAVLink version cannot carry
        self._dialect = dialect
        self._version = version
        self._signing = signing
        self._parser = Parser(dialect, signing=signing)
        self._encoders: dict[Address, Encoder] = {}
        self._other: tuple[Signing | None, Parser] | None = None  # while a change of keys is open
        self._uses_new = False

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
        self._other = None
        self._sign_with(signing, Parser(self._dialect, signing=signing))

    @property
    def clock(self) -> int:
        """The newest timestamp signed or accepted; 0 without signing."""
        return self._signing.timestamp if self._signing else 0

    def listen_also(self, signing: Signing | None) -> None:
        """Open a change of keys: accept also what this state accepts (None: everything)."""
        self._other, self._uses_new = (signing, Parser(self._dialect, signing=signing)), False

    def use_new(self, new: bool) -> None:
        """Sign with the new state, or with the old one, while a change is open."""
        if self._other is not None and new != self._uses_new:
            other, self._other = self._other, (self._signing, self._parser)
            self._uses_new = new
            self._sign_with(*other)

    def settle(self) -> None:
        """Close a change of keys: what is signed with now is all that is accepted."""
        self._other = None

    def _sign_with(self, signing: Signing | None, parser: Parser) -> None:
        self._signing, self._parser = signing, parser
        sequences = {source: encoder.sequence for source, encoder in self._encoders.items()}
        self._encoders.clear()
        for source, sequence in sequences.items():
            self._encoder(source).sequence = sequence

    def receive(self, data: bytes, now: float) -> list[Packet]:
        """The packets that the bytes complete."""
        if self.pacer.half_duplex:
            self.pacer.received(len(data), now)
        if self._signing is None and self._other is None:
            return self._parser.feed(data)
        time = time_if_set(now)
        packets = self._parser.feed(data, time)
        if self._other is not None:
            accepted = {packet.raw for packet in packets}
            packets += [packet for packet in self._other[1].feed(data, time) if packet.raw not in accepted]
        return packets

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
