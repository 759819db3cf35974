"""The clocks of others, as their SYSTEM_TIME tells them, and their starts.

A `time_unix_usec` of 0, or one before 2000, is a clock that nobody set: an autopilot has none before its
first fix.
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

MOST_SOURCES = 256
#: A clock that tells less, in seconds since 1970, was never set.
LEAST_UNIX_TIME = 946_684_800.0


@dataclass(frozen=True, slots=True)
class Rebooted(Event):
    """A component started anew: what is known of it may be old."""

    source: Address


@dataclass(frozen=True, slots=True)
class UnixTimeKnown(Event):
    """A component's clock was set, or heard for the first time; `unix_time` in seconds."""

    source: Address
    unix_time: float


@dataclass(slots=True)
class SystemClock:
    """What a component last told; times in seconds, `unix_time` None if it does not know it."""

    unix_time: float | None = None
    since_boot: float = 0.0
    heard_at: float = 0.0
    reboot: RebootDetector = field(default_factory=RebootDetector, repr=False)

    @property
    def offset(self) -> float | None:
        """How far it is ahead of our clock, not counting what the message took."""
        return None if self.unix_time is None else self.unix_time - self.heard_at


class SystemTimeObserver(Service):
    """Follows the SYSTEM_TIME of everybody."""

    handles = message_ids(common.SystemTime)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._clocks: OrderedDict[Address, SystemClock] = OrderedDict()

    def clock_of(self, source: Address) -> SystemClock | None:
        """The clock of a component, if it told it."""
        return self._clocks.get(source)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.SystemTime(time_unix_usec=unix, time_boot_ms=boot):
                self._heard(Address(packet.system, packet.component), unix / 1e6, boot, now)

    def _heard(self, source: Address, unix_time: float, boot_ms: int, now: float) -> None:
        clock = self._clocks.setdefault(source, SystemClock())
        self._clocks.move_to_end(source)
        if len(self._clocks) > MOST_SOURCES:
            self._clocks.popitem(last=False)
        if clock.reboot.observe(boot_ms, now):
            clock.unix_time = None
            self.emit(Rebooted(source))
        clock.since_boot, clock.heard_at = boot_ms / 1000, now
        if unix_time >= LEAST_UNIX_TIME:
            if clock.unix_time is None:
                self.emit(UnixTimeKnown(source, unix_time))
            clock.unix_time = unix_time
