"""PX4's modes: one table for all types, of which each type has what it can fly.

PX4 tells the names only of modes that are no standard modes. Its HEARTBEAT flags follow from what its
controllers do in a mode: the navigator's modes are automatic, guided and stabilised; the pilot's modes have
manual input, and those that hold an attitude are stabilised.
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
from mavstack.sim.autopilot.interfaces import Mode
from mavstack.sim.px4.behaviours import Descend, Px4Return, Px4Takeoff, Terminated, orbit_behaviour
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.px4.state import Px4State

Make: TypeAlias = "Callable[[Autopilot], Behaviour]"

_STANDARD, _PROPERTY, _FLAGS = common.MavStandardMode, common.MavModeProperty, common.MavModeFlag
_T = VehicleType

#: `custom_mode` of each.
MANUAL: Final = px4_custom_mode(1)
ALTITUDE: Final = px4_custom_mode(2)
POSITION: Final = px4_custom_mode(3)
ORBIT: Final = px4_custom_mode(3, 1)
TAKEOFF: Final = px4_custom_mode(4, 2)
HOLD: Final = px4_custom_mode(4, 3)
MISSION: Final = px4_custom_mode(4, 4)
RETURN: Final = px4_custom_mode(4, 5)
LAND: Final = px4_custom_mode(4, 6)
VTOL_TAKEOFF: Final = px4_custom_mode(4, 10)
DESCEND: Final = px4_custom_mode(4, 20)
ACRO: Final = px4_custom_mode(5)
OFFBOARD: Final = px4_custom_mode(6)
STABILIZED: Final = px4_custom_mode(7)
TERMINATION: Final = px4_custom_mode(10)

#: What DO_SET_MODE does not enter: for these there are commands of their own, or failsafes.
BY_THEMSELVES: Final = frozenset({ORBIT, VTOL_TAKEOFF, DESCEND, TERMINATION})

#: What DO_SET_STANDARD_MODE enters; a wing orbits in Hold.
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
        **{wanted: mode for wanted, mode in STANDARD_MODES.items() if wanted != _STANDARD.POSITION_HOLD},
        _STANDARD.CRUISE: POSITION,
        _STANDARD.ORBIT: HOLD,
    }
)

#: What controllers do, as flags.
_AUTOMATIC: Final = _FLAGS.AUTO_ENABLED | _FLAGS.GUIDED_ENABLED | _FLAGS.STABILIZE_ENABLED
_BY_STICKS: Final = _FLAGS.MANUAL_INPUT_ENABLED | _FLAGS.STABILIZE_ENABLED
_RAW: Final = _FLAGS.MANUAL_INPUT_ENABLED
_STABLE: Final = _FLAGS.STABILIZE_ENABLED

_FLYING: Final = frozenset({_T.COPTER, _T.PLANE, _T.VTOL})
_HOVERING: Final = frozenset({_T.COPTER, _T.VTOL})
_FLOATING: Final = _FLYING | {_T.SUB}
_ALL: Final = frozenset(VehicleType)


@dataclass(frozen=True, slots=True)
class _Row:
    """One mode for every type that has it; `standard` on flying types only."""

    number: int
    name: str
    behaviour: Make
    flags: int
    standard: int = _STANDARD.NON_STANDARD
    types: frozenset[VehicleType] = _ALL
    manual_control: bool = False
    needs_position: bool = True
    may_arm: bool = True
    selectable: bool = True
    then: int | None = None


#: In the order of the firmware's own numbers, which is that of its list.
_TABLE: Final = (
    _Row(MANUAL, "Manual", Manual, _RAW, manual_control=True, needs_position=False),
    _Row(
        ALTITUDE, "Altitude", AltitudeHold, _BY_STICKS, _STANDARD.ALTITUDE_HOLD, _FLOATING,
        manual_control=True, needs_position=False,
    ),
    _Row(POSITION, "Position", PositionHold, _BY_STICKS, manual_control=True),
    _Row(MISSION, "Mission", Mission, _AUTOMATIC, _STANDARD.MISSION),
    _Row(HOLD, "Hold", Hold, _AUTOMATIC),
    _Row(RETURN, "Return", Px4Return, _AUTOMATIC, _STANDARD.SAFE_RECOVERY, may_arm=False),
    _Row(ACRO, "Acro", Acro, _RAW, manual_control=True, needs_position=False),
    _Row(
        DESCEND, "Descend", Descend, _AUTOMATIC,
        needs_position=False, may_arm=False, selectable=False,
    ),
    _Row(
        TERMINATION, "Termination", Terminated, 0, needs_position=False, may_arm=False, selectable=False,
    ),
    _Row(OFFBOARD, "Offboard", Offboard, _STABLE, needs_position=False),
    _Row(STABILIZED, "Stabilized", Stabilize, _BY_STICKS, manual_control=True, needs_position=False),
    _Row(TAKEOFF, "Takeoff", Terminated, _AUTOMATIC, _STANDARD.TAKEOFF, _FLYING, then=HOLD),
    _Row(
        LAND, "Land", Land, _AUTOMATIC, _STANDARD.LAND, _FLYING, needs_position=False, may_arm=False,
    ),
    _Row(ORBIT, "Orbit", Terminated, _STABLE, _STANDARD.ORBIT, _FLYING, may_arm=False),
    _Row(
        VTOL_TAKEOFF, "VTOL Takeoff", Terminated, _AUTOMATIC, types=frozenset({_T.VTOL}),
        then=HOLD,
    ),
)  # fmt: skip


def modes_of(type: VehicleType, state: Px4State) -> tuple[Mode, ...]:  # noqa: A002 (HEARTBEAT's name for it)
    """The modes of a type, in the order of AVAILABLE_MODES; take-offs and orbits go by the state."""
    chosen: dict[int, Make] = {
        TAKEOFF: lambda autopilot: Px4Takeoff(autopilot, state),
        ORBIT: lambda autopilot: orbit_behaviour(autopilot, state.orbit),
        VTOL_TAKEOFF: lambda autopilot: Px4Takeoff(autopilot, state, forward=True),
    }
    rows = (row for row in _TABLE if type in row.types)
    return tuple(_mode(row, type, chosen.get(row.number, row.behaviour)) for row in rows)


def _mode(row: _Row, kind: VehicleType, behaviour: Make) -> Mode:
    standard = _standard_mode(row, kind)
    named = standard == _STANDARD.NON_STANDARD
    return Mode(
        AvailableMode(row.number, row.name if named else "", standard, _properties(row)),
        behaviour,
        flags=_flags(row, kind),
        needs_position=row.needs_position,
        manual_control=row.manual_control,
        may_arm=row.may_arm,
        then=row.then,
        label=row.name,
    )


def _standard_mode(row: _Row, kind: VehicleType) -> int:
    if row.number == POSITION:
        return {_T.COPTER: _STANDARD.POSITION_HOLD, _T.PLANE: _STANDARD.CRUISE}.get(
            kind, _STANDARD.NON_STANDARD
        )
    if row.number in (ALTITUDE, ORBIT) and kind not in _FLYING:
        return _STANDARD.NON_STANDARD
    return row.standard


def _properties(row: _Row) -> int:
    properties = 0 if row.number in (ALTITUDE, POSITION) else int(_PROPERTY.ADVANCED)
    return properties if row.selectable else properties | int(_PROPERTY.NOT_USER_SELECTABLE)


def _flags(row: _Row, kind: VehicleType) -> int:
    """What hovers is stabilised in Manual, too."""
    if row.number == MANUAL and kind in _HOVERING:
        return int(_BY_STICKS)
    return int(row.flags)
