"""PX4's modes: one table for all types; each type has the modes that it can fly.

PX4 reports names only of modes that are not standard modes. The HEARTBEAT flags follow from the active
controllers: the navigator's modes are automatic, guided and stabilised; the pilot's modes have manual input,
and those that hold an attitude are stabilised.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.services.modes import AvailableMode
from mavstack.services.modes.names import px4_custom_mode
from mavstack.sim.autopilot.behaviours import (
    Acro,
    AltitudeHold,
    Hold,
    Land,
    Manual,
    Offboard,
    PositionHold,
    Stabilize,
)
from mavstack.sim.autopilot.behaviours.mission import Mission
from mavstack.sim.autopilot.firmware_profile import Mode
from mavstack.sim.px4.behaviours import Descend, Px4Return, Px4Takeoff, Terminated, orbit_behaviour
from mavstack.sim.px4.follow import FollowTarget
from mavstack.sim.px4.precision_landing import PrecisionLand
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.px4.state import Px4State

BehaviourFactory: TypeAlias = "Callable[[SimulatedAutopilot], Behaviour]"

_STANDARD, _PROPERTY, _FLAGS = common.MavStandardMode, common.MavModeProperty, common.MavModeFlag
_T = VehicleType

#: The `custom_mode` of each mode.
MANUAL: Final = px4_custom_mode(1)
ALTITUDE: Final = px4_custom_mode(2)
POSITION: Final = px4_custom_mode(3)
ORBIT: Final = px4_custom_mode(3, 1)
TAKEOFF: Final = px4_custom_mode(4, 2)
HOLD: Final = px4_custom_mode(4, 3)
MISSION: Final = px4_custom_mode(4, 4)
RETURN: Final = px4_custom_mode(4, 5)
LAND: Final = px4_custom_mode(4, 6)
FOLLOW_TARGET: Final = px4_custom_mode(4, 8)
PRECISION_LAND: Final = px4_custom_mode(4, 9)
VTOL_TAKEOFF: Final = px4_custom_mode(4, 10)
DESCEND: Final = px4_custom_mode(4, 20)
ACRO: Final = px4_custom_mode(5)
OFFBOARD: Final = px4_custom_mode(6)
STABILIZED: Final = px4_custom_mode(7)
TERMINATION: Final = px4_custom_mode(10)

#: Modes that DO_SET_MODE cannot enter, because other commands or failsafes enter them.
NOT_SELECTABLE: Final = frozenset({ORBIT, VTOL_TAKEOFF, DESCEND, TERMINATION})

#: Modes that DO_SET_STANDARD_MODE enters, by standard mode; wings use Hold for the orbit mode.
STANDARD_MODES: Final[Mapping[int, int]] = MappingProxyType(
    {
        _STANDARD.SAFE_RECOVERY: RETURN,
        _STANDARD.MISSION: MISSION,
        _STANDARD.LAND: LAND,
        _STANDARD.TAKEOFF: TAKEOFF,
        _STANDARD.ALTITUDE_HOLD: ALTITUDE,
        _STANDARD.POSITION_HOLD: POSITION,
        _STANDARD.ORBIT: ORBIT,
    }
)
STANDARD_MODES_OF_WINGS: Final[Mapping[int, int]] = MappingProxyType(
    {
        **{
            standard_mode: mode
            for standard_mode, mode in STANDARD_MODES.items()
            if standard_mode != _STANDARD.POSITION_HOLD
        },
        _STANDARD.CRUISE: POSITION,
        _STANDARD.ORBIT: HOLD,
    }
)

#: MAV_MODE_FLAG bits, by the controllers that are active in a mode.
_AUTOMATIC: Final = _FLAGS.AUTO_ENABLED | _FLAGS.GUIDED_ENABLED | _FLAGS.STABILIZE_ENABLED
_MANUAL_STABILIZED: Final = _FLAGS.MANUAL_INPUT_ENABLED | _FLAGS.STABILIZE_ENABLED
_MANUAL_RAW: Final = _FLAGS.MANUAL_INPUT_ENABLED
_STABILIZED_ONLY: Final = _FLAGS.STABILIZE_ENABLED

_FLYING: Final = frozenset({_T.COPTER, _T.PLANE, _T.VTOL})
_HOVERING: Final = frozenset({_T.COPTER, _T.VTOL})
_FLYING_AND_SUB: Final = _FLYING | {_T.SUB}
_ALL: Final = frozenset(VehicleType)


@dataclass(frozen=True, slots=True)
class _Row:
    """One mode for every type that has it; `standard` applies to flying types only."""

    number: int
    name: str
    behaviour: BehaviourFactory
    flags: int
    standard: int = _STANDARD.NON_STANDARD
    types: frozenset[VehicleType] = _ALL
    manual_control: bool = False
    needs_position: bool = True
    may_arm: bool = True
    selectable: bool = True
    then: int | None = None


#: All modes, in the order of the firmware's mode numbers, which is the order of AVAILABLE_MODES.
_TABLE: Final = (
    _Row(MANUAL, "Manual", Manual, _MANUAL_RAW, manual_control=True, needs_position=False),
    _Row(
        ALTITUDE, "Altitude", AltitudeHold, _MANUAL_STABILIZED, _STANDARD.ALTITUDE_HOLD, _FLYING_AND_SUB,
        manual_control=True, needs_position=False,
    ),
    _Row(POSITION, "Position", PositionHold, _MANUAL_STABILIZED, manual_control=True),
    _Row(MISSION, "Mission", Mission, _AUTOMATIC, _STANDARD.MISSION),
    _Row(HOLD, "Hold", Hold, _AUTOMATIC),
    _Row(RETURN, "Return", Px4Return, _AUTOMATIC, _STANDARD.SAFE_RECOVERY, may_arm=False),
    _Row(ACRO, "Acro", Acro, _MANUAL_RAW, manual_control=True, needs_position=False),
    _Row(
        DESCEND, "Descend", Descend, _AUTOMATIC,
        needs_position=False, may_arm=False, selectable=False,
    ),
    _Row(
        TERMINATION, "Termination", Terminated, 0, needs_position=False, may_arm=False, selectable=False,
    ),
    _Row(OFFBOARD, "Offboard", Offboard, _STABILIZED_ONLY, needs_position=False),
    _Row(STABILIZED, "Stabilized", Stabilize, _MANUAL_STABILIZED, manual_control=True, needs_position=False),
    _Row(TAKEOFF, "Takeoff", Terminated, _AUTOMATIC, _STANDARD.TAKEOFF, _FLYING, then=HOLD),
    _Row(
        LAND, "Land", Land, _AUTOMATIC, _STANDARD.LAND, _FLYING, needs_position=False, may_arm=False,
    ),
    _Row(
        FOLLOW_TARGET, "Follow Target", FollowTarget, _AUTOMATIC, types=frozenset({_T.COPTER}), may_arm=False,
    ),
    _Row(
        PRECISION_LAND, "Precision Land", PrecisionLand, _AUTOMATIC, types=frozenset({_T.COPTER}),
        may_arm=False,
    ),
    _Row(ORBIT, "Orbit", Terminated, _STABILIZED_ONLY, _STANDARD.ORBIT, _FLYING, may_arm=False),
    _Row(
        VTOL_TAKEOFF, "VTOL Takeoff", Terminated, _AUTOMATIC, types=frozenset({_T.VTOL}),
        then=HOLD,
    ),
)  # fmt: skip


def modes_of(vehicle_type: VehicleType, state: Px4State) -> tuple[Mode, ...]:
    """Return the modes of a type, in the order of AVAILABLE_MODES."""
    factories: dict[int, BehaviourFactory] = {
        TAKEOFF: lambda autopilot: Px4Takeoff(autopilot, state),
        ORBIT: lambda autopilot: orbit_behaviour(autopilot, state.orbit),
        VTOL_TAKEOFF: lambda autopilot: Px4Takeoff(autopilot, state, forward=True),
    }
    rows = (row for row in _TABLE if vehicle_type in row.types)
    return tuple(_mode(row, vehicle_type, factories.get(row.number, row.behaviour)) for row in rows)


def _mode(row: _Row, vehicle_type: VehicleType, behaviour: BehaviourFactory) -> Mode:
    """Return the mode of a row."""
    standard = _standard_mode(row, vehicle_type)
    named = standard == _STANDARD.NON_STANDARD
    return Mode(
        AvailableMode(row.number, row.name if named else "", standard, _properties(row)),
        behaviour,
        flags=_flags(row, vehicle_type),
        needs_position=row.needs_position,
        manual_control=row.manual_control,
        may_arm=row.may_arm,
        then=row.then,
        label=row.name,
    )


def _standard_mode(row: _Row, vehicle_type: VehicleType) -> int:
    """Return the MAV_STANDARD_MODE of a row."""
    if row.number == POSITION:
        return {_T.COPTER: _STANDARD.POSITION_HOLD, _T.PLANE: _STANDARD.CRUISE}.get(
            vehicle_type, _STANDARD.NON_STANDARD
        )
    if row.number in (ALTITUDE, ORBIT) and vehicle_type not in _FLYING:
        return _STANDARD.NON_STANDARD
    return row.standard


def _properties(row: _Row) -> int:
    """Return the MAV_MODE_PROPERTY flags of a row."""
    properties = 0 if row.number in (ALTITUDE, POSITION) else int(_PROPERTY.ADVANCED)
    return properties if row.selectable else properties | int(_PROPERTY.NOT_USER_SELECTABLE)


def _flags(row: _Row, vehicle_type: VehicleType) -> int:
    """Return the MAV_MODE_FLAG bits of a row; hovering types are stabilised in Manual, too."""
    if row.number == MANUAL and vehicle_type in _HOVERING:
        return int(_MANUAL_STABILIZED)
    return int(row.flags)
