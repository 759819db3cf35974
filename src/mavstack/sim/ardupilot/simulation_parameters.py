"""SIM_ parameters: faults and wind, set by any ground station as in ArduPilot's own simulator.

    SIM_GPS1_ENABLE, SIM_GPS_DISABLE     GPS; the second is the older name
    SIM_GPS1_GLTCH_X, _Y, SIM_GPS_GLITCH_X, _Y    offset of latitude and longitude in degrees
    SIM_RC_FAIL                          1 or 2: no radio reception
    SIM_ENGINE_FAIL, SIM_ENGINE_MUL      bits of motors, which the multiplier 0 stops
    SIM_BATT_VOLTAGE                     voltage of a full battery
    SIM_MAG_ERROR, SIM_BARO_GLITCH       degrees, metres
    SIM_WIND_SPD, SIM_WIND_DIR, SIM_WIND_TURB    m/s, degrees of origin, m/s of gusts: for the whole world

The values survive a reboot, as those of other parameters do.
"""

from __future__ import annotations

from functools import partial
from math import cos, isfinite, radians
from typing import TYPE_CHECKING

from mavstack.geodesy import METRES_PER_DEGREE
from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.motion.battery import CELL_VOLTAGE

if TYPE_CHECKING:
    from mavstack.services.parameters import Value
    from mavstack.sim.vehicle import SimulatedVehicle

_NEW_PREFIX, _OLD_PREFIX = "SIM_GPS1_GLTCH_", "SIM_GPS_GLITCH_"


class SimulationParameters:
    """Applies the SIM_ parameters to one vehicle."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._parameters = vehicle.parameters
        on_change, inject = self._parameters.on_change, vehicle.faults.inject
        for name in ("SIM_GPS1_ENABLE", "SIM_GPS_DISABLE"):
            on_change(name, partial(self._switch_gps, name))
        for axis in "XY":
            on_change(_NEW_PREFIX + axis, partial(self._mirror, _NEW_PREFIX, _OLD_PREFIX))
            on_change(_OLD_PREFIX + axis, partial(self._mirror, _OLD_PREFIX, _NEW_PREFIX))
        on_change("SIM_RC_FAIL", lambda value: inject(f"radio {_state(bool(value))}"))
        on_change("SIM_ENGINE_FAIL", self._fail_motors)
        on_change("SIM_ENGINE_MUL", self._fail_motors)
        on_change("SIM_BATT_VOLTAGE", self._set_battery_sag)
        on_change("SIM_MAG_ERROR", lambda value: inject(f"compass {_finite(value)}"))
        on_change("SIM_BARO_GLITCH", lambda value: inject(f"baro {_finite(value)}"))
        for name in ("SIM_WIND_SPD", "SIM_WIND_DIR", "SIM_WIND_TURB"):
            on_change(name, self._set_wind)

    def _number(self, name: str) -> float:
        """Return a parameter as a finite number."""
        return _finite(self._parameters[name])

    def _switch_gps(self, name: str, value: Value) -> None:
        """Enable or disable GPS, and keep both names equal."""
        off = bool(value) is (name == "SIM_GPS_DISABLE")
        if off is ("gps" not in self._vehicle.faults.active):
            self._vehicle.faults.inject(f"gps {_state(off)}")
        self._parameters.set("SIM_GPS1_ENABLE", int(not off))
        self._parameters.set("SIM_GPS_DISABLE", int(off))

    def _mirror(self, changed: str, other: str, _: Value) -> None:
        """Apply a GPS offset, and keep both names equal."""
        north, east = (self._number(changed + axis) for axis in "XY")
        home = self._vehicle.body.frame
        metres = METRES_PER_DEGREE * cos(radians(home.latitude))
        self._vehicle.faults.inject(f"gps spoof {north * METRES_PER_DEGREE} {east * metres}")
        for axis in "XY":
            self._parameters.set(other + axis, self._number(changed + axis))

    def _fail_motors(self, _: Value) -> None:
        """Apply failed motors."""
        failed = int(self._number("SIM_ENGINE_FAIL")) if self._number("SIM_ENGINE_MUL") <= 0 else 0
        for motor in range(1, AIRFRAMES[self._vehicle.vehicle_type].motors + 1):
            off = bool(failed >> (motor - 1) & 1)
            if off is (f"motor {motor}" not in self._vehicle.faults.active):
                self._vehicle.faults.inject(f"motor {motor} {_state(off)}")

    def _set_battery_sag(self, value: Value) -> None:
        """Apply the battery voltage."""
        full = float(CELL_VOLTAGE[-1]) * self._vehicle.body.battery.cells
        self._vehicle.faults.inject(f"battery sag {max(round(full - _finite(value), 3), 0.0)}")

    def _set_wind(self, _: Value) -> None:
        """Apply the wind."""
        speed, gusts = self._number("SIM_WIND_SPD"), self._number("SIM_WIND_TURB")
        share = gusts / speed if speed > 0 else 0.0
        self._vehicle.body.set_wind(speed, self._number("SIM_WIND_DIR"), share)


def _state(off: bool) -> str:
    """Return the word of a state."""
    return "off" if off else "on"


def _finite(value: Value) -> float:
    """Return a value, or 0 if it is not finite."""
    return float(value) if isfinite(value) else 0.0
