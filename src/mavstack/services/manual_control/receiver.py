"""Being steered by hand over the link: who steers, how, and that nobody does any more.

Each source's newest input is kept with its age; after `timeout` seconds without a message it is lost, sticks
and channels alike. An override changes only the channels that it names, so those of a source add up until it
releases them. A packet that its successors have overtaken on the way is left out.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.manual_control.inputs import RELEASE, ChannelOverride, ManualInput
from mavstack.services.service import Event, Service, earliest

if TYPE_CHECKING:
    from mavstack.wire import Packet

TIMEOUT = 1.0
OVERRIDE_TIMEOUT = 3.0
#: So many sources may steer at once; more are refused until one of these is lost.
MAX_SOURCES = 32
#: A sequence number that is this far ahead, of 256, is behind.
_BEHIND = 192
#: Packets overtake each other by less than this.
_OVERTAKEN_WITHIN = 0.5

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class ManualInputReceived(Event):
    """Somebody moved the sticks, or still holds them."""

    source: Address
    input: ManualInput


@dataclass(frozen=True, slots=True)
class ManualInputLost(Event):
    """Somebody who held the sticks is not heard any more."""

    source: Address


@dataclass(frozen=True, slots=True)
class OverrideReceived(Event):
    """Channels that somebody overrides now, all together; empty if all were released."""

    source: Address
    channels: MappingProxyType[int, int]


@dataclass(frozen=True, slots=True)
class OverrideLost(Event):
    """Somebody who overrode channels is not heard any more: they are the radio control's again."""

    source: Address


@dataclass(slots=True)
class _Held(Generic[Value]):
    value: Value
    sequence: int
    heard_at: float


@dataclass(slots=True)
class _Table(Generic[Value]):
    """What sources hold, and since when nothing was heard of them."""

    timeout: float
    held: dict[Address, _Held[Value]] = field(default_factory=dict)

    def take(self, source: Address, value: Value, sequence: int, now: float) -> bool:
        if source not in self.held and len(self.held) >= MAX_SOURCES:
            return False
        self.held[source] = _Held(value, sequence, now)
        return True

    def is_late(self, source: Address, sequence: int, now: float) -> bool:
        held = self.held.get(source)
        if held is None or now - held.heard_at > _OVERTAKEN_WITHIN:
            return False
        return (sequence - held.sequence) % 256 >= _BEHIND

    def latest(self, source: Address, now: float) -> tuple[Value, float] | None:
        held = self.held.get(source)
        if held is None or now - held.heard_at >= self.timeout:
            return None
        return held.value, now - held.heard_at

    def next_timeout(self) -> float | None:
        return min((held.heard_at + self.timeout for held in self.held.values()), default=None)

    def lost(self, now: float) -> list[tuple[Address, Value]]:
        lost = [source for source, held in self.held.items() if now >= held.heard_at + self.timeout]
        return [(source, self.held.pop(source).value) for source in lost]


class ManualControlReceiver(Service):
    """The sticks and channels of one vehicle, as others hold them."""

    handles = message_ids(common.ManualControl, common.RcChannelsOverride)

    def __init__(
        self, local: Address, *, timeout: float = TIMEOUT, override_timeout: float = OVERRIDE_TIMEOUT
    ) -> None:
        super().__init__(local)
        self.refused_sources = 0
        self.overtaken = 0
        self._inputs: _Table[ManualInput] = _Table(timeout)
        self._overrides: _Table[MappingProxyType[int, int]] = _Table(override_timeout)

    def latest(self, source: Address, now: float) -> tuple[ManualInput, float] | None:
        """A source's sticks and their age in seconds; None if it does not hold them."""
        return self._inputs.latest(source, now)

    def overridden(self, source: Address, now: float) -> tuple[MappingProxyType[int, int], float] | None:
        """The channels that a source overrides, and the age of its last word; None if it does not."""
        held = self._overrides.latest(source, now)
        return held if held and held[0] else None

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.ManualControl(target=system) as message if system in (0, self.local.system):
                if self._is_new(self._inputs, packet, now):
                    sticks = ManualInput.read(message)
                    if self._accepted(self._inputs.take(source, sticks, packet.sequence, now)):
                        self.emit(ManualInputReceived(source, sticks))
            case common.RcChannelsOverride() as message:
                if self._is_new(self._overrides, packet, now):
                    self._override(source, ChannelOverride.read(message), packet.sequence, now)

    def next_timeout(self) -> float | None:
        return earliest(self._inputs.next_timeout(), self._overrides.next_timeout())

    def handle_timeout(self, now: float) -> None:
        for source, _ in self._inputs.lost(now):
            self.emit(ManualInputLost(source))
        for source, channels in self._overrides.lost(now):
            if channels:
                self.emit(OverrideLost(source))

    def _override(self, source: Address, override: ChannelOverride, sequence: int, now: float) -> None:
        held = self._overrides.latest(source, now)
        before = held[0] if held else MappingProxyType({})
        merged = {**before, **override.channels}
        channels = MappingProxyType({key: pulse for key, pulse in merged.items() if pulse != RELEASE})
        # One that holds nothing stays in the table for a while: an overtaken packet must not take hold again.
        taken = self._accepted(self._overrides.take(source, channels, sequence, now))
        if taken and (before or channels):
            self.emit(OverrideReceived(source, channels))

    def _is_new(self, table: _Table[Value], packet: Packet, now: float) -> bool:
        late = table.is_late(Address(packet.system, packet.component), packet.sequence, now)
        self.overtaken += late
        return not late

    def _accepted(self, taken: bool) -> bool:
        self.refused_sources += not taken
        return taken
