"""The state of a channel in the engine: parser, encoders, signing and pacing."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from mavstack.node.pacing import Pacer
from mavstack.security.timestamps import time_if_set
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack._core import HasCoreDialect
    from mavstack.dialects import Message
    from mavstack.services import Address, Priority
    from mavstack.wire import Packet, Signing

_logger = logging.getLogger("mavstack.node")

#: Seconds between two log records about refused packets of a channel.
REFUSAL_LOG_INTERVAL = 10.0


class ChannelState:
    """The state of one channel. Sequence numbers count per channel and local component."""

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
        #: True if signing keys may be installed over the channel: a cable, not a radio.
        self.trusted = False
        #: The link id of its signatures, which tells the channels of one component apart.
        self.link_id = 0
        self.pacer = Pacer(bandwidth, half_duplex=half_duplex, bulk_rate=bulk_rate)
        #: Stream messages dropped because the channel had no room.
        self.thinned = 0
        #: Messages dropped because the channel's MAVLink version cannot carry them.
        self.unsendable = 0
        #: True if every packet that is received is verified, except those of ids accepted unsigned.
        self.verifies = signing is not None
        #: Packets refused because another channel verifies their sender.
        self.unverified = 0
        self._dialect = dialect
        self._version = version
        self._signing = signing
        self._parser = Parser(dialect, signing=signing)
        self._encoders: dict[Address, Encoder] = {}
        self._other: tuple[Signing | None, Parser] | None = None  # during a change of keys
        self._uses_new = False
        self._logged_refusals = 0
        self._next_refusal_log = 0.0

    @property
    def parser(self) -> Parser:
        """The parser of received bytes; see its `statistics`."""
        return self._parser

    @property
    def signing(self) -> Signing | None:
        """The signing state of both directions; None: unsigned. Setting it starts a new parser."""
        return self._signing

    @signing.setter
    def signing(self, signing: Signing | None) -> None:
        self._other = None
        self.verifies = signing is not None
        self._sign_with(signing, Parser(self._dialect, signing=signing))

    @property
    def clock(self) -> int:
        """The newest signing timestamp sent or accepted, in units of 10 us; 0 without signing."""
        return self._signing.timestamp if self._signing else 0

    def accept_also(self, signing: Signing | None) -> None:
        """Start a change of keys: accept packets of this signing state as well (None: unsigned)."""
        self._other, self._uses_new = (signing, Parser(self._dialect, signing=signing)), False
        self.verifies = self._signing is not None and signing is not None

    def use_new(self, new: bool) -> None:
        """Sign with the new state, or with the old one, during a change of keys."""
        if self._other is not None and new != self._uses_new:
            other, self._other = self._other, (self._signing, self._parser)
            self._uses_new = new
            self._sign_with(*other)

    def settle(self) -> None:
        """End a change of keys: accept only packets of the state that signs now."""
        self._other = None
        self.verifies = self._signing is not None

    def _sign_with(self, signing: Signing | None, parser: Parser) -> None:
        self._signing, self._parser = signing, parser
        self._logged_refusals = signing.refusals.total if signing is not None else 0
        sequences = {source: encoder.sequence for source, encoder in self._encoders.items()}
        self._encoders.clear()
        for source, sequence in sequences.items():
            self._encoder(source).sequence = sequence

    def receive(self, data: bytes, now: float) -> list[Packet]:
        """Return the packets that the bytes complete."""
        if self.pacer.half_duplex:
            self.pacer.received(len(data), now)
        if self._signing is None and self._other is None:
            return self._parser.feed(data)
        time = time_if_set(now)
        packets = self._parser.feed(data, time)
        if self._other is None:
            self._log_refusals(now)
        else:
            accepted = {packet.raw for packet in packets}
            packets += [packet for packet in self._other[1].feed(data, time) if packet.raw not in accepted]
        return packets

    def proves_validity(self, packets: list[Packet]) -> bool:
        """Return whether received packets prove a valid peer: with signing, only signed ones do."""
        return self._signing is None or any(packet.signed for packet in packets)

    def _log_refusals(self, now: float) -> None:
        """Log newly refused packets, at most once per `REFUSAL_LOG_INTERVAL`."""
        total = self._signing.refusals.total if self._signing is not None else 0
        if total > self._logged_refusals and now >= self._next_refusal_log:
            count, self._logged_refusals = total - self._logged_refusals, total
            self._next_refusal_log = now + REFUSAL_LOG_INTERVAL
            _logger.warning(
                "channel %s: %d packets refused: unsigned, replayed or signed with another key",
                self.name,
                count,
            )

    def encode(self, message: Message, source: Address, now: float, priority: Priority) -> bytes:
        """Encode a message for the channel and count it as sent; may raise EncodeError."""
        data = self._encoder(source).encode(message, now)
        self.pacer.sent(len(data), now, priority)
        return data

    def _encoder(self, source: Address) -> Encoder:
        encoder = self._encoders.get(source)
        if encoder is None:
            encoder = Encoder(source.system, source.component, version=self._version, signing=self._signing)
            self._encoders[source] = encoder
        return encoder
