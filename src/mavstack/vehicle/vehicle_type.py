"""The types of vehicles: how a vehicle moves decides which actions it supports."""

from __future__ import annotations

from enum import StrEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Mapping

_T: Final = common.MavType

#: The parameter of ArduPlane that turns a plane into a quadplane.
QUADPLANE_PARAMETER: Final = "Q_ENABLE"


class VehicleType(StrEnum):
    """The way a vehicle moves, from its MAV_TYPE; the value is its name in texts."""

    COPTER = "copter"
    PLANE = "plane"
    VTOL = "VTOL"
    ROVER = "rover"
    BOAT = "boat"
    SUB = "submarine"
    OTHER = "vehicle"

    @property
    def flies(self) -> bool:
        """True if vehicles of this type take off and land."""
        return self in _FLYING

    @property
    def has_altitude(self) -> bool:
        """True if vehicles of this type climb or dive; others have no altitude to go to."""
        return self not in (VehicleType.ROVER, VehicleType.BOAT)

    @property
    def circles(self) -> bool:
        """True if vehicles of this type may circle a position instead of hovering over it."""
        return self in (VehicleType.PLANE, VehicleType.VTOL)

    @property
    def typical_speed(self) -> float:
        """The speed in m/s with which plans estimate durations and divide work, unless one is given."""
        return _TYPICAL_SPEEDS.get(self, 5.0)

    @classmethod
    def of(cls, mav_type: int) -> VehicleType:
        """Return the vehicle type of a MAV_TYPE; `OTHER` for types that are not vehicles."""
        return _BY_MAV_TYPE.get(mav_type, cls.OTHER)


def flies_on_wing(vehicle_type: VehicleType, vtol_state: int | None) -> bool:
    """Return whether a vehicle flies on its wing now, by its MAV_VTOL_STATE, and cannot stand still."""
    hovers = vtol_state == common.MavVtolState.MC
    return vehicle_type is VehicleType.PLANE or (vehicle_type is VehicleType.VTOL and not hovers)


_TYPICAL_SPEEDS: Final[Mapping[VehicleType, float]] = MappingProxyType(
    {
        VehicleType.PLANE: 15.0,
        VehicleType.VTOL: 15.0,
        VehicleType.ROVER: 2.0,
        VehicleType.BOAT: 2.0,
        VehicleType.SUB: 1.0,
    }
)
_FLYING: Final = frozenset({VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL, VehicleType.OTHER})
_COPTERS: Final = (
    _T.QUADROTOR, _T.COAXIAL, _T.HELICOPTER, _T.HEXAROTOR, _T.OCTOROTOR, _T.TRICOPTER, _T.DODECAROTOR,
    _T.DECAROTOR, _T.GENERIC_MULTIROTOR,
)  # fmt: skip
_VTOLS: Final = (
    _T.VTOL_TAILSITTER_DUOROTOR, _T.VTOL_TAILSITTER_QUADROTOR, _T.VTOL_TILTROTOR, _T.VTOL_FIXEDROTOR,
    _T.VTOL_TAILSITTER, _T.VTOL_TILTWING, _T.VTOL_RESERVED5,
)  # fmt: skip
_BY_MAV_TYPE: Final[Mapping[int, VehicleType]] = MappingProxyType(
    {
        **dict.fromkeys(_COPTERS, VehicleType.COPTER),
        **dict.fromkeys(_VTOLS, VehicleType.VTOL),
        _T.FIXED_WING: VehicleType.PLANE,
        _T.GROUND_ROVER: VehicleType.ROVER,
        _T.SURFACE_BOAT: VehicleType.BOAT,
        _T.SUBMARINE: VehicleType.SUB,
    }
)
