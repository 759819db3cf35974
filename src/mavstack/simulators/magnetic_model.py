"""The Earth's magnetic field by the World Magnetic Model 2025.

The field is the gradient of a potential that is a sum of spherical harmonics of degree 1 to 12, with the
Schmidt normalisation. Estimators compare the measured field with such a model, so a simple dipole is not
enough: it is 20 % and some degrees off in Europe.
"""

from __future__ import annotations

import math
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Final

from mavstack.geodesy import ECCENTRICITY_SQUARED, MAGNETIC_RADIUS, SEMI_MAJOR_AXIS

if TYPE_CHECKING:
    from mavstack.rotation import Vector

#: The year of the coefficients, and the default year of a simulation.
EPOCH, YEAR = 2025.0, 2026.0
_DEGREE: Final = 12
_GAUSS: Final = 1e-5


def magnetic_field(latitude: float, longitude: float, altitude: float = 0.0, *, year: float = YEAR) -> Vector:
    """Return the magnetic field at a place.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above the ellipsoid.
        year: Decimal year; the model is valid from 2025 to 2030.

    Returns:
        Gauss north, east, down.
    """
    geodetic = math.radians(latitude)
    radius, geocentric = _geocentric(geodetic, altitude)
    north, east, down = _spherical(radius, geocentric, math.radians(longitude), year - EPOCH)
    tilt = geocentric - geodetic
    cosine, sine = math.cos(tilt), math.sin(tilt)
    return (_GAUSS * (north * cosine - down * sine), _GAUSS * east, _GAUSS * (north * sine + down * cosine))


@cache
def _coefficients() -> tuple[tuple[int, int, float, float, float, float], ...]:
    """Return the rows of the file of coefficients, which its head describes."""
    text = (files(__package__) / "magnetic_coefficients.txt").read_text("ascii")
    rows = (line.split() for line in text.splitlines() if not line.startswith("#"))
    return tuple((int(n), int(m), float(g), float(h), float(dg), float(dh)) for n, m, g, h, dg, dh in rows)


def _geocentric(latitude: float, altitude: float) -> tuple[float, float]:
    """Return the distance from the Earth's centre, and the geocentric latitude."""
    sine = math.sin(latitude)
    normal = SEMI_MAJOR_AXIS / math.sqrt(1.0 - ECCENTRICITY_SQUARED * sine * sine)
    across = (normal + altitude) * math.cos(latitude)
    along = (normal * (1.0 - ECCENTRICITY_SQUARED) + altitude) * sine
    radius = math.hypot(across, along)
    return radius, math.asin(along / radius)


def _spherical(radius: float, latitude: float, longitude: float, years: float) -> Vector:
    """Return the field in nanotesla north, east, down on a sphere."""
    sine = max(math.cos(latitude), 1e-9)  # sine of the colatitude, which must not be zero
    values, slopes = _legendre(math.sin(latitude), sine)
    north = east = down = 0.0
    for n, m, g_start, h_start, g_change, h_change in _coefficients():
        g, h = g_start + years * g_change, h_start + years * h_change
        share = (MAGNETIC_RADIUS / radius) ** (n + 2)
        cosine, turn = math.cos(m * longitude), math.sin(m * longitude)
        along = g * cosine + h * turn
        north += share * along * slopes[n][m]
        east += share * m * (g * turn - h * cosine) * values[n][m] / sine
        down -= share * (n + 1) * along * values[n][m]
    return north, east, down


def _legendre(cosine: float, sine: float) -> tuple[list[list[float]], list[list[float]]]:
    """Return the Schmidt functions of a colatitude, and their derivatives by it."""
    size = _DEGREE + 1
    values = [[0.0] * size for _ in range(size)]
    slopes = [[0.0] * size for _ in range(size)]
    values[0][0] = 1.0
    for n in range(1, size):
        for m in range(n):
            k = ((n - 1) ** 2 - m * m) / ((2 * n - 1) * (2 * n - 3)) if n > 1 else 0.0
            values[n][m] = cosine * values[n - 1][m] - k * values[n - 2][m]
            slopes[n][m] = cosine * slopes[n - 1][m] - sine * values[n - 1][m] - k * slopes[n - 2][m]
        values[n][n] = sine * values[n - 1][n - 1]
        slopes[n][n] = sine * slopes[n - 1][n - 1] + cosine * values[n - 1][n - 1]
    _normalise(values)
    _normalise(slopes)
    return values, slopes


def _normalise(table: list[list[float]]) -> None:
    """Multiply by the factors of Schmidt."""
    first = 1.0
    for n in range(1, _DEGREE + 1):
        first *= (2 * n - 1) / n
        factor = first
        table[n][0] *= factor
        for m in range(1, n + 1):
            factor *= math.sqrt((n - m + 1) * (2 if m == 1 else 1) / (n + m))
            table[n][m] *= factor
