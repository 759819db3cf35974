"""The observer of SYSTEM_TIME: the clocks of other components, and their reboots.

A `time_unix_usec` of 0, or one before 2000, means a clock that was not set: an autopilot has no Unix time
before its first fix.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service
from mavstack.services.system_time.reboot import RebootDetector

if TYPE_CHECKING:
    from mavstack.wire import Packet

MAX_SOURCES = 256
#: Earlier Unix times, in seconds, mean that the clock was not set.
MIN_UNIX_TIME = 946_684_800.0


@dataclass(frozen=True, slots=True)
class Rebooted(Event):
    """A component rebooted: state cached of it may be stale."""

    source: Address


@dataclass(frozen=True, slots=True)
class UnixTimeKnown(Event):
    """A component's clock was set, or received for the first time; `unix_time` in seconds."""

    source: Address
    unix_time: float


@dataclass(slots=True)
class SystemClock:
    """The last SYSTEM_TIME of a component; times in seconds, `unix_time` is None if its clock is not set."""

    unix_time: float | None = None
    since_boot: float = 0.0
    received_at: float = 0.0
    reboot: RebootDetector = field(default_factory=RebootDetector, repr=False)

    @property
    def offset(self) -> float | None:
        """Seconds by which the clock is ahead of the local one, without the delay of the message."""
        return None if self.unix_time is None else self.unix_time - self.received_at


class SystemTimeObserver(Service):
    """The observer of the SYSTEM_TIME of all components."""

    handles = message_ids(common.SystemTime)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._clocks: OrderedDict[Address, SystemClock] = OrderedDict()

    def clock_of(self, source: Address) -> SystemClock | None:
        """Return the clock of a component, if it sent SYSTEM_TIME."""
        return self._clocks.get(source)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.SystemTime(time_unix_usec=unix, time_boot_ms=boot):
                self._update(Address(packet.system, packet.component), unix / 1e6, boot, now)

    def _update(self, source: Address, unix_time: float, boot_ms: int, now: float) -> None:
        clock = self._clocks.setdefault(source, SystemClock())
        self._clocks.move_to_end(source)
        if len(self._clocks) > MAX_SOURCES:
            self._clocks.popitem(last=False)
        if clock.reboot.observe(boot_ms, now):
            clock.unix_time = None
            self.emit(Rebooted(source))
        clock.since_boot, clock.received_at = boot_ms / 1000, now
        if unix_time >= MIN_UNIX_TIME:
            if clock.unix_time is None:
                self.emit(UnixTimeKnown(source, unix_time))
            clock.unix_time = unix_time
