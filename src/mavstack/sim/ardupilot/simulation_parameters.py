"""SIM_ parameters: faults and weather as ArduPilot's own simulator takes them from any ground station.

    SIM_GPS1_ENABLE, SIM_GPS_DISABLE     satellites; the second is the older name
    SIM_GPS1_GLTCH_X, _Y, SIM_GPS_GLITCH_X, _Y    degrees of latitude and longitude that the receiver is off
    SIM_RC_FAIL                          1 or 2: the transmitter is not heard
    SIM_ENGINE_FAIL, SIM_ENGINE_MUL      bits of motors, which the multiplier 0 stops
    SIM_BATT_VOLTAGE                     what a full battery would give
    SIM_MAG_ERROR, SIM_BARO_GLITCH       degrees, metres
    SIM_WIND_SPD, SIM_WIND_DIR, SIM_WIND_TURB    m/s, degrees it comes from, m/s of gusts: of the whole world

They are kept over a reboot, as other parameters are.
"""

from __future__ import annotations

from functools import partial
from math import cos, isfinite, radians
from typing import TYPE_CHECKING, Final

from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.motion.battery import CELL_VOLTAGE

if TYPE_CHECKING:
    from mavstack.services.parameters import Value
    from mavstack.sim.autopilot.interfaces import Vehicle

_METRES_OF_DEGREE: Final = 111_195.0
_NEWER, _OLDER = "SIM_GPS1_GLTCH_", "SIM_GPS_GLITCH_"


class SimulationParameters:
    """Lets them act on one vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._parameters = vehicle.parameters
        watch, inject = self._parameters.on_change, vehicle.faults.inject
        for name in ("SIM_GPS1_ENABLE", "SIM_GPS_DISABLE"):
            watch(name, partial(self._switch_gps, name))
        for axis in "XY":
            watch(_NEWER + axis, partial(self._mirror, _NEWER, _OLDER))
            watch(_OLDER + axis, partial(self._mirror, _OLDER, _NEWER))
        watch("SIM_RC_FAIL", lambda value: inject(f"radio {_off(bool(value))}"))
        watch("SIM_ENGINE_FAIL", self._fail_motors)
        watch("SIM_ENGINE_MUL", self._fail_motors)
        watch("SIM_BATT_VOLTAGE", self._sag)
        watch("SIM_MAG_ERROR", lambda value: inject(f"compass {_finite(value)}"))
        watch("SIM_BARO_GLITCH", lambda value: inject(f"baro {_finite(value)}"))
        for name in ("SIM_WIND_SPD", "SIM_WIND_DIR", "SIM_WIND_TURB"):
            watch(name, self._blow)

    def _number(self, name: str) -> float:
        return _finite(self._parameters[name])

    def _switch_gps(self, name: str, value: Value) -> None:
        """Both names say the same."""
        off = bool(value) is (name == "SIM_GPS_DISABLE")
        if off is ("gps" not in self._vehicle.faults.active):
            self._vehicle.faults.inject(f"gps {_off(off)}")
        self._parameters.set("SIM_GPS1_ENABLE", int(not off))
        self._parameters.set("SIM_GPS_DISABLE", int(off))

    def _mirror(self, changed: str, other: str, _: Value) -> None:
        """The other names are made to say the same, and the receiver too."""
        north, east = (self._number(changed + axis) for axis in "XY")
        home = self._vehicle.body.frame
        metres = _METRES_OF_DEGREE * cos(radians(home.latitude))
        self._vehicle.faults.inject(f"gps spoof {north * _METRES_OF_DEGREE} {east * metres}")
        for axis in "XY":
            self._parameters.set(other + axis, self._number(changed + axis))

    def _fail_motors(self, _: Value) -> None:
        failed = int(self._number("SIM_ENGINE_FAIL")) if self._number("SIM_ENGINE_MUL") <= 0 else 0
        for motor in range(1, AIRFRAMES[self._vehicle.type].motors + 1):
            off = bool(failed >> (motor - 1) & 1)
            if off is (f"motor {motor}" not in self._vehicle.faults.active):
                self._vehicle.faults.inject(f"motor {motor} {_off(off)}")

    def _sag(self, value: Value) -> None:
        full = float(CELL_VOLTAGE[-1]) * self._vehicle.body.battery.cells
        self._vehicle.faults.inject(f"battery sag {max(round(full - _finite(value), 3), 0.0)}")

    def _blow(self, _: Value) -> None:
        speed, gusts = self._number("SIM_WIND_SPD"), self._number("SIM_WIND_TURB")
        share = gusts / speed if speed > 0 else 0.0
        self._vehicle.body.set_wind(speed, self._number("SIM_WIND_DIR"), share)


def _off(off: bool) -> str:
    return "off" if off else "on"


def _finite(value: Value) -> float:
    return float(value) if isfinite(value) else 0.0
