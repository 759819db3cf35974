"""The standard atmosphere up to 20 km, with the pressure and the temperature of the day."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

#: 0 degrees Celsius in kelvin, the temperature lapse rate in K/m, and the altitude of the tropopause in
#: metres.
_ZERO, _LAPSE, _TROPOPAUSE = 273.15, 0.0065, 11_000.0
#: Gravity, the gas constant of dry air, and the exponent of the pressure that follows from them.
_GRAVITY, _GAS = 9.80665, 287.05287
_EXPONENT: Final = _GRAVITY / (_GAS * _LAPSE)
#: The range of altitudes in metres; beyond it, the values at the limit are used.
_LOWEST, _HIGHEST = -1000.0, 20_000.0


@dataclass(frozen=True, slots=True)
class Atmosphere:
    """The air above a place.

    Attributes:
        sea_level: Pressure at sea level in hPa.
        temperature: Temperature at sea level in degrees Celsius.
    """

    sea_level: float = 1013.25
    temperature: float = 15.0

    def temperature_at(self, altitude: float) -> float:
        """Return the temperature in degrees Celsius at an altitude in metres above mean sea level."""
        return self.temperature - _LAPSE * min(max(altitude, _LOWEST), _TROPOPAUSE)

    def pressure_at(self, altitude: float) -> float:
        """Return the pressure in hPa at an altitude in metres above mean sea level."""
        altitude = min(max(altitude, _LOWEST), _HIGHEST)
        kelvin = self.temperature + _ZERO
        low = min(altitude, _TROPOPAUSE)
        pressure = self.sea_level * math.pow(1.0 - _LAPSE * low / kelvin, _EXPONENT)
        if altitude > low:
            pressure *= math.exp(-_GRAVITY * (altitude - low) / (_GAS * (kelvin - _LAPSE * low)))
        return pressure

    def density_at(self, altitude: float) -> float:
        """Return the density in kg/m3 at an altitude in metres above mean sea level."""
        return 100.0 * self.pressure_at(altitude) / (_GAS * (self.temperature_at(altitude) + _ZERO))

    def dynamic_pressure(self, airspeed: float, altitude: float) -> float:
        """Return the dynamic pressure in hPa of a true airspeed in m/s."""
        return 0.005 * self.density_at(altitude) * airspeed * airspeed


STANDARD: Final = Atmosphere()
