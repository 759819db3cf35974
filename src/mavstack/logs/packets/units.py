"""The units of MAVLink fields, split into a unit without a prefix and a factor.

The definitions name the unit of the number that is sent: `degE7` for degrees times ten million, `cdegC` for
hundredths of a degree. A table in its units has degrees and degrees Celsius. Units in common use stay as they
are: km, kg, kPa, hPa, MHz, mAh, MiB.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

_PLAIN_UNITS: Final[Mapping[str, tuple[str, float]]] = MappingProxyType(
    {
        "degE7": ("deg", 1e-7),
        "degE5": ("deg", 1e-5),
        "cdeg": ("deg", 1e-2),
        "ddeg/s": ("deg/s", 1e-1),
        "deg/2": ("deg", 2.0),
        "cdegC": ("degC", 1e-2),
        "mrad/s": ("rad/s", 1e-3),
        "mm": ("m", 1e-3),
        "cm": ("m", 1e-2),
        "dm": ("m", 1e-1),
        "dam": ("m", 10.0),
        "mm/s": ("m/s", 1e-3),
        "cm/s": ("m/s", 1e-2),
        "dm/s": ("m/s", 1e-1),
        "m/s*5": ("m/s", 0.2),
        "mV": ("V", 1e-3),
        "cV": ("V", 1e-2),
        "mA": ("A", 1e-3),
        "cA": ("A", 1e-2),
        "ns": ("s", 1e-9),
        "us": ("s", 1e-6),
        "ms": ("s", 1e-3),
        "cs": ("s", 1e-2),
        "ds": ("s", 1e-1),
        "mG": ("G", 1e-3),
        "mgauss": ("gauss", 1e-3),
        "c%": ("%", 1e-2),
        "d%": ("%", 1e-1),
        "dpix": ("pix", 1e-1),
        "hJ": ("J", 1e2),
    }
)


def plain_unit(unit: str, factor: float) -> tuple[str, float]:
    """Return a unit without a prefix, and the factor that converts a stored value to it.

    Args:
        unit: Unit of a field as the definitions spell it, or empty.
        factor: The multiplier of the definition, 1 if it has none; the unit is that of the product.

    Returns:
        The unit and the factor.
    """
    plain, prefix = _PLAIN_UNITS.get(unit, (unit, 1.0))
    return plain, prefix * factor
