"""Radio control: a simulated transmitter, RC_CHANNELS_OVERRIDE and MANUAL_CONTROL.

The transmitter is on, with centred sticks and closed throttle, unless there is none (as in PX4's simulations)
or it is switched off to simulate a loss of radio control. Overridden channels replace the transmitter's while
the override lasts, and MANUAL_CONTROL replaces the four sticks.
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
    from mavstack.sim.vehicle import SimulatedVehicle

CHANNELS = 18
#: Lowest, middle and highest pulse width, in microseconds.
LOW, MIDDLE, HIGH = 1000, 1500, 2000
ROLL, PITCH, THROTTLE, YAW = range(4)
_FULL = 1000.0


class Sticks(NamedTuple):
    """Sticks from -1 to 1: right, nose up (stick pulled), turn right; throttle from 0 to 1."""

    roll: float
    pitch: float
    throttle: float
    yaw: float


class RadioControl:
    """The pilot's input to one vehicle."""

    def __init__(
        self, vehicle: SimulatedVehicle, *, transmitter: bool, may_steer: Callable[[Address], bool]
    ) -> None:
        self._vehicle = vehicle
        self._may_steer = may_steer
        self._hovers_at_middle = vehicle.vehicle_type is VehicleType.SUB or vehicle.vehicle_type.on_surface
        # a pulled pitch stick is a low pulse on channel 2 for ArduPilot, and a high pulse for PX4
        self._pulled = 1.0 if vehicle.firmware is Firmware.ARDUPILOT else -1.0
        #: True if there is a transmitter; `switched_on` is True while it transmits.
        self.has_transmitter = transmitter
        self.switched_on = transmitter and "radio" not in vehicle.faults.active
        self._own = [MIDDLE] * 4 + [HIGH - 200] * 4 + [0] * (CHANNELS - 8)
        if not self._hovers_at_middle:
            self._own[THROTTLE] = LOW
        #: True if there was any input since boot.
        self.was_present = self.switched_on
        self._overridden: dict[Address, dict[int, int]] = {}
        self._inputs: dict[Address, ManualInput] = {}
        #: Time of the last input that came over MAVLink (RC_CHANNELS_OVERRIDE or MANUAL_CONTROL).
        self.received_at = vehicle.now if self.switched_on else float("-inf")
        vehicle.on_event(OverrideReceived, self._override)
        vehicle.on_event(OverrideLost, lambda event: self._release(event.source))
        vehicle.on_event(ManualInputReceived, self._take)
        vehicle.on_event(ManualInputLost, lambda event: self._let_go(event.source))

    @property
    def present(self) -> bool:
        """True while there is input, from the transmitter or over the link."""
        return self.switched_on or bool(self._overridden) or bool(self._inputs)

    @property
    def rssi(self) -> int:
        """RSSI as in RC_CHANNELS: 0 to 254, 255 if unknown."""
        return 254 if self.switched_on else 0 if self.has_transmitter else 255

    @property
    def channels(self) -> tuple[int, ...]:
        """All eighteen channels in microseconds; 0 for an unused one."""
        channels = list(self._own) if self.switched_on else [0] * CHANNELS
        for overridden in self._overridden.values():
            for channel, pulse in overridden.items():
                channels[channel - 1] = pulse
        return tuple(channels)

    @property
    def sticks(self) -> Sticks:
        """The position of the sticks; centred, with closed throttle, if there is no input."""
        for held in self._inputs.values():
            return self._sticks_of(held)
        roll, pitch, throttle, yaw = self.channels[:4]
        return Sticks(_share(roll), self._pulled * _share(pitch), self._throttle(throttle), _share(yaw))

    def move(self, channel: int, pulse: int) -> None:
        """Move a stick or switch of the transmitter; channels count from 1."""
        self._own[channel - 1] = pulse

    def switch(self, on: bool) -> None:
        """Switch the transmitter on or off."""
        self.switched_on = on and self.has_transmitter
        if self.switched_on:
            self._heard()

    def clear_overrides(self) -> None:
        """Drop all overridden channels."""
        self._overridden.clear()

    def _throttle(self, pulse: int) -> float:
        if pulse == 0:
            return 0.5 if self._hovers_at_middle else 0.0
        return (_share(pulse) + 1) / 2

    def _sticks_of(self, held: ManualInput) -> Sticks:
        """Convert MANUAL_CONTROL: z is 0 to 1000, for surface vehicles -1000 to 1000."""
        roll, pitch, yaw = ((value or 0) / _FULL for value in (held.y, held.x, held.r))
        if self._vehicle.vehicle_type.on_surface:
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
        self.was_present, self.received_at = True, self._vehicle.now

    def _release(self, source: Address) -> None:
        self._overridden.pop(source, None)

    def _let_go(self, source: Address) -> None:
        self._inputs.pop(source, None)


def _share(pulse: int) -> float:
    """Convert a pulse width to -1 … 1."""
    if pulse == 0:
        return 0.0
    return min(max((pulse - MIDDLE) / (HIGH - MIDDLE), -1.0), 1.0)
