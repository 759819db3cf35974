"""The receiver of manual control: who controls the vehicle, and when control is lost.

Each source's latest input is kept with its age; after `timeout` seconds without a message it is lost, for
sticks and channels alike. An override changes only the channels that it names, so those of a source
accumulate until it releases them. Reordered packets are ignored.
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

DEFAULT_TIMEOUT = 1.0
DEFAULT_OVERRIDE_TIMEOUT = 3.0
#: The largest number of concurrent sources; further ones are refused until one of these is lost.
MAX_SOURCES = 32
#: A sequence number that is ahead by this much or more, modulo 256, is an older one.
_BEHIND = 192
#: Seconds within which packets may be reordered.
_REORDER_WINDOW = 0.5

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class ManualInputReceived(Event):
    """A source sent stick positions."""

    source: Address
    input: ManualInput


@dataclass(frozen=True, slots=True)
class ManualInputLost(Event):
    """A source stopped sending stick positions."""

    source: Address


@dataclass(frozen=True, slots=True)
class OverrideReceived(Event):
    """All channels that a source overrides now; empty if all were released."""

    source: Address
    channels: MappingProxyType[int, int]


@dataclass(frozen=True, slots=True)
class OverrideLost(Event):
    """A source of overrides stopped sending: its channels belong to the RC receiver again."""

    source: Address


@dataclass(slots=True)
class _Input(Generic[Value]):
    value: Value
    sequence: int
    received_at: float


@dataclass(slots=True)
class _Table(Generic[Value]):
    """The latest values of the sources, and when they were received."""

    timeout: float
    held: dict[Address, _Input[Value]] = field(default_factory=dict)

    def put(self, source: Address, value: Value, sequence: int, now: float) -> bool:
        if source not in self.held and len(self.held) >= MAX_SOURCES:
            return False
        self.held[source] = _Input(value, sequence, now)
        return True

    def is_late(self, source: Address, sequence: int, now: float) -> bool:
        held = self.held.get(source)
        if held is None or now - held.received_at > _REORDER_WINDOW:
            return False
        return (sequence - held.sequence) % 256 >= _BEHIND

    def latest(self, source: Address, now: float) -> tuple[Value, float] | None:
        held = self.held.get(source)
        if held is None or now - held.received_at >= self.timeout:
            return None
        return held.value, now - held.received_at

    def next_timeout(self) -> float | None:
        return min((held.received_at + self.timeout for held in self.held.values()), default=None)

    def lost(self, now: float) -> list[tuple[Address, Value]]:
        lost = [source for source, held in self.held.items() if now >= held.received_at + self.timeout]
        return [(source, self.held.pop(source).value) for source in lost]


class ManualControlReceiver(Service):
    """The receiver of stick positions and channel overrides for one vehicle."""

    handles = message_ids(common.ManualControl, common.RcChannelsOverride)

    def __init__(
        self,
        local: Address,
        *,
        timeout: float = DEFAULT_TIMEOUT,
        override_timeout: float = DEFAULT_OVERRIDE_TIMEOUT,
    ) -> None:
        super().__init__(local)
        self.refused_sources = 0
        self.reordered = 0
        self._inputs: _Table[ManualInput] = _Table(timeout)
        self._overrides: _Table[MappingProxyType[int, int]] = _Table(override_timeout)

    def latest(self, source: Address, now: float) -> tuple[ManualInput, float] | None:
        """Return a source's stick positions and their age in seconds; None if it sends none."""
        return self._inputs.latest(source, now)

    def overridden(self, source: Address, now: float) -> tuple[MappingProxyType[int, int], float] | None:
        """Return a source's overridden channels and their age in seconds; None if it overrides none."""
        held = self._overrides.latest(source, now)
        return held if held and held[0] else None

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.ManualControl(target=system) as message if system in (0, self.local.system):
                if self._is_new(self._inputs, packet, now):
                    sticks = ManualInput.read(message)
                    if self._accepted(self._inputs.put(source, sticks, packet.sequence, now)):
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
        # A source that released all channels stays in the table for a while, so that a reordered packet does
        # not override channels again.
        taken = self._accepted(self._overrides.put(source, channels, sequence, now))
        if taken and (before or channels):
            self.emit(OverrideReceived(source, channels))

    def _is_new(self, table: _Table[Value], packet: Packet, now: float) -> bool:
        late = table.is_late(Address(packet.system, packet.component), packet.sequence, now)
        self.reordered += late
        return not late

    def _accepted(self, taken: bool) -> bool:
        self.refused_sources += not taken
        return taken
