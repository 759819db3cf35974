"""What the pilot's hands do: a simulated transmitter, channels overridden over the link, MANUAL_CONTROL.

The transmitter lies switched on with centred sticks and the throttle closed, unless it was never there (PX4's
simulations have none) or is switched off, which is how radio control is lost on purpose. Overridden channels
replace its own for as long as somebody overrides them, and MANUAL_CONTROL replaces the four sticks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mavstack.services.manual_control import (
    ManualInputLost,
    ManualInputReceived,
    OverrideLost,
    OverrideReceived,
)
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services import Address
    from mavstack.services.manual_control import ManualInput
    from mavstack.sim.autopilot.state import VehicleState

CHANNELS = 18
#: Pulses in microseconds.
LOW, MIDDLE, HIGH = 1000, 1500, 2000
ROLL, PITCH, THROTTLE, YAW = range(4)
_FULL = 1000.0


class Sticks(NamedTuple):
    """-1 to 1: right, nose up (stick pulled), turn right; throttle from 0 to 1, 0.5 in the middle."""

    roll: float
    pitch: float
    throttle: float
    yaw: float


class RadioControl:
    """What one vehicle hears of its pilot."""

    def __init__(
        self, vehicle: VehicleState, *, transmitter: bool, may_steer: Callable[[Address], bool]
    ) -> None:
        self._vehicle = vehicle
        self._may_steer = may_steer
        self._hovers_at_middle = vehicle.type is VehicleType.SUB or vehicle.type.on_surface
        # ArduPilot's channel 2 is low for a stick that is pushed, PX4's is high.
        self._pulled = 1.0 if vehicle.firmware is Firmware.ARDUPILOT else -1.0
        #: Whether there is a transmitter, and whether it is switched on.
        self.fitted = transmitter
        self.switched_on = transmitter and "radio" not in vehicle.faults.active
        self._own = [MIDDLE] * 4 + [HIGH - 200] * 4 + [0] * (CHANNELS - 8)
        if not self._hovers_at_middle:
            self._own[THROTTLE] = LOW
        #: Whether hands were ever heard since the start.
        self.was_present = self.switched_on
        self._overridden: dict[Address, dict[int, int]] = {}
        self._inputs: dict[Address, ManualInput] = {}
        #: When somebody last steered over the link.
        self.heard_at = vehicle.now if self.switched_on else float("-inf")
        vehicle.on(OverrideReceived, self._override)
        vehicle.on(OverrideLost, lambda event: self._release(event.source))
        vehicle.on(ManualInputReceived, self._take)
        vehicle.on(ManualInputLost, lambda event: self._let_go(event.source))

    @property
    def present(self) -> bool:
        """Whether anybody's hands are heard now, by radio or over the link."""
        return self.switched_on or bool(self._overridden) or bool(self._inputs)

    @property
    def rssi(self) -> int:
        """As RC_CHANNELS has it: 0 to 254, 255 for not known."""
        return 254 if self.switched_on else 0 if self.fitted else 255

    @property
    def channels(self) -> tuple[int, ...]:
        """All eighteen channels in microseconds; 0 for one that is not there."""
        channels = list(self._own) if self.switched_on else [0] * CHANNELS
        for overridden in self._overridden.values():
            for channel, pulse in overridden.items():
                channels[channel - 1] = pulse
        return tuple(channels)

    @property
    def sticks(self) -> Sticks:
        """Where the sticks are; centred, throttle closed, if nobody holds any."""
        for held in self._inputs.values():
            return self._sticks_of(held)
        roll, pitch, throttle, yaw = self.channels[:4]
        return Sticks(_share(roll), self._pulled * _share(pitch), self._throttle(throttle), _share(yaw))

    def move(self, channel: int, pulse: int) -> None:
        """Move a stick or switch of the transmitter: channels count from 1."""
        self._own[channel - 1] = pulse

    def switch(self, on: bool) -> None:
        """Switch the transmitter on or off."""
        self.switched_on = on and self.fitted
        if self.switched_on:
            self._heard()

    def clear_overrides(self) -> None:
        """Forget the channels that are overridden, as if everybody had released them."""
        self._overridden.clear()

    def _throttle(self, pulse: int) -> float:
        if pulse == 0:
            return 0.5 if self._hovers_at_middle else 0.0
        return (_share(pulse) + 1) / 2

    def _sticks_of(self, held: ManualInput) -> Sticks:
        """MANUAL_CONTROL: z is 0 to 1000 for what flies or dives, -1000 to 1000 for what drives."""
        roll, pitch, yaw = ((value or 0) / _FULL for value in (held.y, held.x, held.r))
        if self._vehicle.type.on_surface:
            throttle = ((held.z or 0) / _FULL + 1) / 2
        else:
            throttle = min(max((_FULL / 2 if held.z is None else held.z) / _FULL, 0.0), 1.0)
        return Sticks(roll, -pitch, throttle, yaw)

    def _override(self, event: OverrideReceived) -> None:
        if not self._may_steer(event.source):
            return
        if event.channels:
            self._overridden[event.source] = dict(event.channels)
            self._heard()
        else:
            self._release(event.source)

    def _take(self, event: ManualInputReceived) -> None:
        if self._may_steer(event.source):
            self._inputs[event.source] = event.input
            self._heard()

    def _heard(self) -> None:
        self.was_present, self.heard_at = True, self._vehicle.now

    def _release(self, source: Address) -> None:
        self._overridden.pop(source, None)

    def _let_go(self, source: Address) -> None:
        self._inputs.pop(source, None)


def _share(pulse: int) -> float:
    """-1 to 1."""
    if pulse == 0:
        return 0.0
    return min(max((pulse - MIDDLE) / (HIGH - MIDDLE), -1.0), 1.0)
