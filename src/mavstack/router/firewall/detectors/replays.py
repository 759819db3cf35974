"""Replays: a recorded packet that is sent again.

A signed packet is unique, since its signature has a timestamp: a copy is a replay. An unsigned one may be the
same as an earlier one, the sequence number included, when its sender repeats itself after 256 packets.
Requests that were sent a few times only are hardly ever the same by chance (one in 256 for each earlier
one), and their senders repeat them with a new number until they are answered: a copy of such a request is
refused. A copy of a message that is sent often is refused if its number is not one that its sender can have
reached now. Copies within `echo` seconds come from redundant links, and are not refused.
"""

from __future__ import annotations

from hashlib import blake2b
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.router.config.quantities import duration
from mavstack.router.firewall.detector import Detector, make_room
from mavstack.services import Address, message_ids

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import Table
    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet

#: Seconds for which packets are kept, and seconds within which a copy comes from a redundant link.
DEFAULT_WINDOW: Final = 600.0
DEFAULT_ECHO: Final = 1.0
#: Maximum number of packets, and of senders, that are kept.
MAX_PACKETS: Final = 20_000
MAX_SENDERS: Final = 1024
#: Number of times within the window below which a request counts as rare: two equal ones are then a replay.
MAX_RARE: Final = 5
#: Maximum number of sequence numbers between two inspected packets of a sender.
MAX_AHEAD: Final = 96
#: Requests with an answer: if it is missing, the sender repeats the request with a new sequence number.
ANSWERED: Final = message_ids(
    common.CommandLong,
    common.CommandInt,
    common.ParamSet,
    common.MissionCount,
    common.MissionItem,
    common.MissionItemInt,
    common.MissionClearAll,
)


class Replays(Detector):
    """Refuses commands, missions, parameters and modes that were sent before."""

    name: ClassVar[str] = "replays"
    messages: frozenset[int] = ANSWERED | message_ids(
        common.Heartbeat,
        common.SetMode,
        common.MissionSetCurrent,
        common.SetPositionTargetLocalNed,
        common.SetPositionTargetGlobalInt,
    )

    def __init__(self) -> None:
        self.window, self.echo = DEFAULT_WINDOW, DEFAULT_ECHO
        self._seen: dict[bytes, float] = {}
        self._sent: dict[bytes, list[float]] = {}
        self._newest: dict[Address, int] = {}

    def configure(self, options: Table) -> None:
        """Read the options of the detector."""
        self.window = options.converted("window", duration, self.window)
        self.echo = options.converted("echo", duration, self.echo)

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        if isinstance(packet.message, common.Heartbeat):
            self._note_sequence(packet)
            return  # equal heartbeats are normal; they only show the sender's current sequence number
        digest = _digest(packet.raw)
        seen = self._seen.get(digest)
        if seen is None or now - seen > self.window:
            make_room(self._seen, MAX_PACKETS)
            self._seen.pop(digest, None)
            self._seen[digest] = now
            self._times(packet, now).append(now)
        elif now - seen > self.echo and (
            packet.signed or not self._is_in_sequence(packet) or self._is_rare(packet, now)
        ):
            yield self.alert(origin, packet, f"{packet.name} was sent before, {now - seen:.0f} s ago")
            return
        if self._is_in_sequence(packet):
            self._note_sequence(packet)

    def _is_in_sequence(self, packet: Packet) -> bool:
        """Return whether a sequence number is one that the sender can have reached now."""
        newest = self._newest.get(Address(packet.system, packet.component))
        return newest is None or (packet.sequence - newest) % 256 <= MAX_AHEAD

    def _note_sequence(self, packet: Packet) -> None:
        make_room(self._newest, MAX_SENDERS)
        self._newest[Address(packet.system, packet.component)] = packet.sequence

    def _is_rare(self, packet: Packet, now: float) -> bool:
        """Return whether a request was sent so seldom that two of them are not the same by chance."""
        return packet.message_id in ANSWERED and len(self._times(packet, now)) < MAX_RARE

    def _times(self, packet: Packet, now: float) -> list[float]:
        """Return the newest times within the window at which a message was sent, with any sequence number."""
        sequence = 4 if packet.version == 2 else 2
        key = _digest(packet.raw[:sequence] + packet.raw[sequence + 1 : -2])
        make_room(self._sent, MAX_PACKETS)
        times = [time for time in self._sent.pop(key, ()) if now - time <= self.window]
        self._sent[key] = times[-MAX_RARE:]  # the caller adds one more time
        return self._sent[key]


def _digest(data: bytes) -> bytes:
    return blake2b(data, digest_size=16).digest()
