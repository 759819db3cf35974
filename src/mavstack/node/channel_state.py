"""The state of a channel in the engine: parser, encoders, MAVLink version, signing and pacing.

With the version "auto" a channel sends MAVLink 2, unless its peer has only sent MAVLink 1. The first packet
of MAVLink 2, or an AUTOPILOT_VERSION with the capability MAVLINK2, returns it to MAVLink 2 permanently. A
signed channel always sends MAVLink 2, the only version with signatures.
"""

from __future__ import annotations

import logging
from itertools import count
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.node.api_object import LoopBound
from mavstack.node.pacing import Pacer, is_radio
from mavstack.security.timestamps import time_if_set
from mavstack.services import message_ids
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack._core import HasCoreDialect
    from mavstack.dialects import Message
    from mavstack.links.settings import Version
    from mavstack.services import Address, Priority
    from mavstack.wire import Packet, Signing

_logger = logging.getLogger("mavstack.node")

#: Seconds between two log records about refused packets of a channel.
REFUSAL_LOG_INTERVAL = 10.0
_AUTOPILOT_VERSION = next(iter(message_ids(common.AutopilotVersion)))


class ChannelState(LoopBound):
    """The state of one channel. Sequence numbers count per channel and local component."""

    def __init__(
        self,
        name: str,
        dialect: HasCoreDialect,
        *,
        version: Version = 2,
        signing: Signing | None = None,
        bandwidth: float | None = None,
        half_duplex: bool = False,
        bulk_rate: float | None = None,
    ) -> None:
        self.name = name
        #: True if signing keys may be sent over the channel: True for a cable, False for a radio.
        self.trusted = False
        #: The link id in signatures, which distinguishes the channels of one component.
        self.link_id = 0
        self.pacer = Pacer(bandwidth, half_duplex=half_duplex, bulk_rate=bulk_rate)
        #: Stream messages dropped because the channel had no room.
        self.thinned = 0
        #: Messages dropped because the channel's MAVLink version cannot carry them.
        self.unsendable = 0
        #: True if every received packet is verified, except packets of message ids that are accepted
        #: unsigned.
        self.verifies = signing is not None
        #: Called when the parser is replaced, and when a second parser is added.
        self.on_parser_changed: Callable[[], None] = lambda: None
        #: Packets refused because packets of the same sender are verified on another channel.
        self.unverified = 0
        self._dialect = dialect
        #: True if the version of sent packets follows the peer's; False once the peer has sent MAVLink 2.
        self.negotiates = version == "auto"
        self._version: int = 2 if version == "auto" else version
        self._signing = signing
        self._parser = Parser(dialect, signing=signing)
        self._encoders: dict[Address, Encoder] = {}
        # key and parser beside the first ones, during a change of keys
        self._other: tuple[Signing | None, Parser] | None = None
        self._uses_new = False
        self._logged_refusals = 0
        self._next_refusal_log = 0.0

    @property
    def parser(self) -> Parser:
        """The parser of received bytes; see its `statistics`."""
        return self._parser

    @property
    def is_plain(self) -> bool:
        """True if received bytes need a parser alone: no signatures, version to follow, or air time."""
        return not (self._signing or self._other or self.negotiates or self.pacer.half_duplex)

    @property
    def version(self) -> int:
        """The MAVLink version of sent packets."""
        return self._version if self._signing is None else 2

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
        self.on_parser_changed()

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
        self.on_parser_changed()
        self._logged_refusals = signing.refusals.total if signing is not None else 0
        self._renew_encoders()

    def _renew_encoders(self) -> None:
        """Replace the encoders after a change of version or signing; the sequence numbers go on."""
        sequences = {source: encoder.sequence for source, encoder in self._encoders.items()}
        self._encoders.clear()
        for source, sequence in sequences.items():
            (self._encoders.get(source) or self._new_encoder(source)).sequence = sequence

    def receive(self, data: bytes, now: float) -> list[Packet]:
        """Return the packets that the bytes complete."""
        if self.pacer.half_duplex:
            self.pacer.received(len(data), now)
        packets = self._parse(data, now)
        if self.negotiates and packets:
            self._negotiate(packets)
        return packets

    def _parse(self, data: bytes, now: float) -> list[Packet]:
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

    def _negotiate(self, packets: list[Packet]) -> None:
        """Follow the version that the peer speaks; a radio on the way is not the peer."""
        versions = {packet.version for packet in packets if not is_radio(packet.component)}
        if not versions:
            return
        if 2 in versions or any(_announces_version_2(packet) for packet in packets):
            self.negotiates = False
            self._send_version(2)
        else:
            self._send_version(1)

    def _send_version(self, version: int) -> None:
        if version != self._version:
            self._version = version
            self._renew_encoders()
            _logger.info("channel %s: MAVLink %d", self.name, self.version)

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
        data = (self._encoders.get(source) or self._new_encoder(source)).encode(message, now)
        self.pacer.sent(len(data), now, priority)
        return data

    def _new_encoder(self, source: Address) -> Encoder:
        encoder = Encoder(source.system, source.component, version=self.version, signing=self._signing)
        self._encoders[source] = encoder
        return encoder


def unique_name(name: str, channels: Iterable[ChannelState]) -> str:
    """Return a name that no other open channel has: facts about senders are kept by it."""
    taken = {channel.name for channel in channels}
    numbered = (f"{name} ({number})" for number in count(2))
    return name if name not in taken else next(each for each in numbered if each not in taken)


def _announces_version_2(packet: Packet) -> bool:
    """Return whether a packet is an AUTOPILOT_VERSION of a component that can speak MAVLink 2."""
    if packet.message_id != _AUTOPILOT_VERSION or packet.message is None:
        return False
    return bool(packet.message.capabilities & common.MavProtocolCapability.MAVLINK2)
