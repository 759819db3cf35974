"""The classes of vehicles: how one moves decides what it can be asked, and how its firmware wants it
asked.
"""

from __future__ import annotations

from enum import StrEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Mapping

_T: Final = common.MavType


class VehicleType(StrEnum):
    """How a vehicle moves."""

    COPTER = "copter"
    PLANE = "plane"
    VTOL = "VTOL"
    ROVER = "rover"
    BOAT = "boat"
    SUB = "submarine"
    OTHER = "vehicle"

    @property
    def flies(self) -> bool:
        """Whether it takes off and lands."""
        return self in _FLYING

    @property
    def circles(self) -> bool:
        """Whether it cannot stand still in the air, or need not."""
        return self in (VehicleType.PLANE, VehicleType.VTOL)

    @classmethod
    def of(cls, vehicle_type: int) -> VehicleType:
        """The class of a MAV_TYPE."""
        return _CLASSES.get(vehicle_type, cls.OTHER)


_FLYING: Final = frozenset({VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL, VehicleType.OTHER})
_COPTERS: Final = (
    _T.QUADROTOR, _T.COAXIAL, _T.HELICOPTER, _T.HEXAROTOR, _T.OCTOROTOR, _T.TRICOPTER, _T.DODECAROTOR,
    _T.DECAROTOR, _T.GENERIC_MULTIROTOR,
)  # fmt: skip
_VTOLS: Final = (
    _T.VTOL_TAILSITTER_DUOROTOR, _T.VTOL_TAILSITTER_QUADROTOR, _T.VTOL_TILTROTOR, _T.VTOL_FIXEDROTOR,
    _T.VTOL_TAILSITTER, _T.VTOL_TILTWING, _T.VTOL_RESERVED5,
)  # fmt: skip
_CLASSES: Final[Mapping[int, VehicleType]] = MappingProxyType(
    {
        **dict.fromkeys(_COPTERS, VehicleType.COPTER),
        **dict.fromkeys(_VTOLS, VehicleType.VTOL),
        _T.FIXED_WING: VehicleType.PLANE,
        _T.GROUND_ROVER: VehicleType.ROVER,
        _T.SURFACE_BOAT: VehicleType.BOAT,
        _T.SUBMARINE: VehicleType.SUB,
    }
)
