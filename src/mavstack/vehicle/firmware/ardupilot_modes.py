"""The modes of ArduPilot by their use: where it arms, starts by itself, waits, holds its position, lands.

Sources: `allows_arming` of each mode of Copter, Rover and Sub, `_pre_arm_checks` of the modes of Plane, 4.5.
The page reads these tables too (`mode_facts`).
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The mode in which each vehicle type stays where it is; if there is a choice, a mode that does not use the
#: throttle stick.
HOLD: Final[Mapping[VehicleType, str]] = MappingProxyType(
    {
        VehicleType.COPTER: "BRAKE",
        VehicleType.PLANE: "LOITER",
        VehicleType.VTOL: "LOITER",
        VehicleType.ROVER: "HOLD",
        VehicleType.BOAT: "LOITER",
        VehicleType.SUB: "POSHOLD",
    }
)
#: The mode in which each vehicle type lands where it is.
LAND: Final[Mapping[VehicleType, str]] = MappingProxyType(
    {VehicleType.COPTER: "LAND", VehicleType.VTOL: "QLAND"}
)
#: Modes of a vehicle on a wing that control the throttle.
_WINGS: Final = frozenset({"takeoff", "auto", "autoland", "circle", "avoid_adsb", "thermal"})
_SURFACE: Final = frozenset({"auto", "circle", "follow", "dock"})
#: Modes that end on the ground, and in which a plane does not arm (in RTL since version 4.2).
_ENDING: Final = frozenset({"rtl", "qrtl", "qland", "initializing"})
_ENDING_ON_SURFACE: Final = frozenset({"rtl", "smart_rtl", "initializing"})
#: The modes in which each vehicle type does not arm, in lower case. A copter stays in RTL, LAND or AUTO after
#: its landing, and must leave the mode before it arms. A submarine arms in all of its modes.
NO_ARMING: Final[Mapping[VehicleType, frozenset[str]]] = MappingProxyType(
    {
        VehicleType.COPTER: frozenset(
            {"auto", "auto_rtl", "rtl", "smart_rtl", "land", "brake", "circle", "flip", "autotune", "follow"}
            | {"systemid", "avoid_adsb", "autorotate"}
        ),
        VehicleType.PLANE: _ENDING,
        VehicleType.VTOL: _ENDING,
        VehicleType.ROVER: _ENDING_ON_SURFACE,
        VehicleType.BOAT: _ENDING_ON_SURFACE,
    }
)
#: The modes in which an armed vehicle on the ground starts without a further command: a plane with automatic
#: throttle runs along the ground as soon as it moves.
SELF_STARTING: Final[Mapping[VehicleType, frozenset[str]]] = MappingProxyType(
    {
        VehicleType.COPTER: frozenset({"auto", "throw"}),
        VehicleType.PLANE: _WINGS | {"guided", "loiter"},
        VehicleType.VTOL: _WINGS,
        VehicleType.ROVER: _SURFACE,
        VehicleType.BOAT: _SURFACE,
        VehicleType.SUB: frozenset({"auto", "circle"}),
    }
)
#: The mode in which each vehicle type waits on the ground when it is armed.
WAITING: Final[Mapping[VehicleType, str]] = MappingProxyType(
    {
        VehicleType.COPTER: "GUIDED",
        VehicleType.PLANE: "FLY_BY_WIRE_A",
        VehicleType.VTOL: "GUIDED",
        VehicleType.ROVER: "HOLD",
        VehicleType.BOAT: "HOLD",
        VehicleType.SUB: "POSHOLD",
    }
)
