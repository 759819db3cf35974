"""The receiver of setpoints, which detects when they cease.

A source's stream begins with its first valid setpoint and times out when none arrived for `timeout` seconds;
PX4 requires more than two per second, so half a second of silence ends a stream by default. Invalid setpoints
are counted and ignored, and do not keep a stream alive. `time_boot_ms` is the sender's clock: a message that
is older than the one before it, by less than a minute, was reordered and is ignored.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import SetpointError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service
from mavstack.services.setpoints.setpoint import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint, Setpoint

if TYPE_CHECKING:
    from mavstack.wire import Packet

DEFAULT_TIMEOUT = 0.5
#: The largest number of concurrent sources; further ones are refused and counted until one of these times
#: out.
MAX_SOURCES = 32
#: A `time_boot_ms` that is lower by this many milliseconds shows that the clock of the sender restarted.
_RESTARTED = 60_000


@dataclass(frozen=True, slots=True)
class SetpointReceived(Event):
    """A setpoint was received."""

    source: Address
    setpoint: Setpoint


@dataclass(frozen=True, slots=True)
class SetpointsTimedOut(Event):
    """A source stopped sending setpoints; `last` is its last one."""

    source: Address
    last: Setpoint


@dataclass(slots=True)
class _Stream:
    setpoint: Setpoint
    time_boot_ms: int
    received_at: float


class SetpointReceiver(Service):
    """The receiver of the setpoints for one vehicle, by source."""

    handles = message_ids(
        common.SetPositionTargetLocalNed, common.SetPositionTargetGlobalInt, common.SetAttitudeTarget
    )

    def __init__(self, local: Address, *, timeout: float = DEFAULT_TIMEOUT) -> None:
        super().__init__(local)
        self.invalid = 0
        self.refused_sources = 0
        self.reordered = 0
        self.last_reason = ""
        self._timeout = timeout
        self._streams: dict[Address, _Stream] = {}

    @property
    def sources(self) -> tuple[Address, ...]:
        """The sources that send setpoints now."""
        return tuple(self._streams)

    def latest(self, source: Address, now: float) -> tuple[Setpoint, float] | None:
        """Return the latest setpoint of a source and its age in seconds; None if its stream has timed out."""
        stream = self._streams.get(source)
        if stream is None or now - stream.received_at >= self._timeout:
            return None
        return stream.setpoint, now - stream.received_at

    def receive(self, packet: Packet, now: float) -> None:
        try:
            setpoint = _read(packet)
        except SetpointError as reason:
            self.invalid += 1
            self.last_reason = str(reason)
            return
        if setpoint is not None:
            self._accept(Address(packet.system, packet.component), setpoint, packet.message.time_boot_ms, now)

    def next_timeout(self) -> float | None:
        return min((stream.received_at + self._timeout for stream in self._streams.values()), default=None)

    def handle_timeout(self, now: float) -> None:
        for source, stream in tuple(self._streams.items()):
            if now >= stream.received_at + self._timeout:
                del self._streams[source]
                self.emit(SetpointsTimedOut(source, stream.setpoint))

    def _accept(self, source: Address, setpoint: Setpoint, time_boot_ms: int, now: float) -> None:
        stream = self._streams.get(source)
        if stream is None:
            if len(self._streams) >= MAX_SOURCES:
                self.refused_sources += 1
                return
            self._streams[source] = _Stream(setpoint, time_boot_ms, now)
        elif 0 < stream.time_boot_ms - time_boot_ms < _RESTARTED:
            self.reordered += 1
            return
        else:
            stream.setpoint, stream.time_boot_ms, stream.received_at = setpoint, time_boot_ms, now
        self.emit(SetpointReceived(source, setpoint))


def _read(packet: Packet) -> Setpoint | None:
    match packet.message:
        case common.SetPositionTargetLocalNed() as message:
            return LocalSetpoint.read(message)
        case common.SetPositionTargetGlobalInt() as message:
            return GlobalSetpoint.read(message)
        case common.SetAttitudeTarget() as message:
            return AttitudeSetpoint.read(message)
    return None
