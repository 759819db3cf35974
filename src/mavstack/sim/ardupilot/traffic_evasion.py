"""How ArduPilot's vehicles avoid an aircraft (AVD_F_ACTION) and continue afterwards (AVD_F_RCVRY).

For a climb or descent, a horizontal move and a flight at a right angle they enter AVOID_ADSB. A copter flies
away by its speeds, also in the middle of a takeoff; within two seconds after arming and while it is landed it
disarms instead, and in LAND, THROW and FLIP it does nothing. A plane gets a guided target 10 km aside or 10 m
higher or lower, and does nothing in MANUAL and QLAND, in AUTO before its takeoff is complete, and during a
landing. Neither descends below the altitude of its return.
Source: ArduPilot, ArduCopter and ArduPlane, avoidance_adsb.
"""

from __future__ import annotations

from math import hypot
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.failsafes.copter import should_disarm

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.traffic import Contact

_ACTION: Final = common.MavCollisionAction
_COPTER, _PLANE = ardupilotmega.CopterMode, ardupilotmega.PlaneMode
#: The modes in which a copter does not avoid aircraft.
_PASSIVE_MODES: Final = frozenset({_COPTER.LAND, _COPTER.THROW, _COPTER.FLIP})
#: Values of AVD_F_RCVRY: 0 stays in the mode, 1 enters the mode before the avoidance, 2 enters RTL, others
#: enter AUTO if it was active before, else they stay at the place.
_STAY, _RESUME, _RETURN = 0, 1, 2
#: Metres of a plane's guided target: to the side, and in altitude.
_ASIDE: Final = 10_000.0
_STEP: Final = 10.0
_RESTING: Final = 0.1
_AVOIDANCE, _RECOVERY = "AVOIDANCE", "AVOIDANCE_RECOVERY"
_TIMES: Final = {"AVD_W_TIME": 30.0, "AVD_F_TIME": 30.0, "AVD_F_ACTION": 1.0, "AVD_F_ALT_MIN": 0.0}


class CopterEvasion:
    """The avoidance of a copter."""

    #: Seconds, metres over ground (XY) and in altitude (Z).
    DEFAULTS: ClassVar[Mapping[str, float]] = MappingProxyType(
        _TIMES
        | {"AVD_W_DIST_XY": 300.0, "AVD_W_DIST_Z": 300.0, "AVD_F_DIST_XY": 100.0, "AVD_F_DIST_Z": 100.0}
        | {"AVD_F_RCVRY": 2.0}
    )

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._mode_before: int | None = None

    def avoid(self, contact: Contact, action: int) -> int:
        """Avoid an aircraft; return the action that is taken."""
        autopilot = self._autopilot
        first = self._mode_before is None
        if first:
            self._mode_before = autopilot.mode.number
        if autopilot.mode.number in _PASSIVE_MODES:
            return int(_ACTION.NONE)
        if should_disarm(autopilot):
            autopilot.disarm(_AVOIDANCE)
            return int(_ACTION.NONE)
        mode = {int(_ACTION.RTL): _COPTER.RTL, int(_ACTION.HOVER): _COPTER.LOITER}.get(
            action, _COPTER.AVOID_ADSB
        )
        if first:
            autopilot.enter(int(mode), _AVOIDANCE)
        if mode == _COPTER.AVOID_ADSB and autopilot.mode.number == mode:
            autopilot.guided.fly_velocity(*self._velocity(contact, action))
        return action

    def recover(self, choice: int) -> None:
        """Continue the flight, unless a person has changed the mode meanwhile."""
        autopilot, before, self._mode_before = self._autopilot, self._mode_before, None
        if before is None or autopilot.mode_reason != _AVOIDANCE or choice == _STAY:
            return
        again = before if choice == _RESUME or before == _COPTER.AUTO else int(_COPTER.LOITER)
        autopilot.enter(int(_COPTER.RTL) if choice == _RETURN else again, _RECOVERY)

    def _velocity(self, contact: Contact, action: int) -> tuple[float, float, float]:
        """Return the velocity away from an aircraft."""
        limits = self._autopilot.body.limits
        north, east = away_from(self._autopilot, contact)
        vertical = -limits.climb
        if not is_above(self._autopilot, contact):
            vertical = limits.sink if self._may_descend() else 0.0
        if action == _ACTION.ASCEND_OR_DESCEND:
            return 0.0, 0.0, vertical
        sideways = limits.speed * north, limits.speed * east
        return *sideways, 0.0 if action == _ACTION.MOVE_HORIZONTALLY else vertical

    def _may_descend(self) -> bool:
        return self._autopilot.altitude >= self._autopilot.flight_parameters.return_altitude


class PlaneEvasion:
    """The avoidance of a plane."""

    #: Seconds, metres over ground (XY) and in altitude (Z).
    DEFAULTS: ClassVar[Mapping[str, float]] = MappingProxyType(
        _TIMES
        | {"AVD_W_DIST_XY": 1000.0, "AVD_W_DIST_Z": 300.0, "AVD_F_DIST_XY": 300.0, "AVD_F_DIST_Z": 100.0}
        | {"AVD_F_RCVRY": 3.0}
    )

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._mode_before: int | None = None

    def avoid(self, contact: Contact, action: int) -> int:
        """Avoid an aircraft; return the action that is taken."""
        first = self._mode_before is None
        if first:
            self._mode_before = self._autopilot.mode.number
        if self._is_prevented():
            return int(_ACTION.NONE)
        taken = action if self._act(contact, action, first) else int(_ACTION.NONE)
        if first:
            text = f"Avoid: Performing action: {taken}"
            self._autopilot.vehicle.send_statustext(text, common.MavSeverity.ALERT)
        return taken

    def recover(self, choice: int) -> None:
        """Continue the flight, unless a person has changed the mode meanwhile."""
        autopilot, before, self._mode_before = self._autopilot, self._mode_before, None
        if before is None:
            return
        autopilot.vehicle.send_statustext(f"Avoid: Resuming with action: {choice}", common.MavSeverity.INFO)
        if autopilot.mode_reason != _AVOIDANCE or choice == _STAY:
            return
        if choice == _RETURN:
            autopilot.enter(int(_PLANE.RTL), _RECOVERY)
        elif choice == _RESUME or before == _PLANE.AUTO:
            autopilot.enter(before, _RECOVERY)
        else:
            autopilot.guided.go_to(autopilot.maneuvers.place)

    def _is_prevented(self) -> bool:
        """Return whether the mode, a takeoff in AUTO or a landing forbids an action."""
        autopilot = self._autopilot
        mode, behaviour = autopilot.mode.number, autopilot.behaviour
        if mode in (_PLANE.MANUAL, _PLANE.QLAND):
            return True
        if behaviour is None:
            return False
        return behaviour.landing or (mode == _PLANE.AUTO and behaviour.taking_off)

    def _act(self, contact: Contact, action: int, first: bool) -> bool:
        autopilot = self._autopilot
        if action in (_ACTION.RTL, _ACTION.HOVER):
            hold = _PLANE.QLOITER if self._hovers() else _PLANE.LOITER
            if first:
                autopilot.enter(int(_PLANE.RTL if action == _ACTION.RTL else hold), _AVOIDANCE)
            return True
        if first:
            autopilot.enter(int(_PLANE.AVOID_ADSB), _AVOIDANCE)
        down = None if action == _ACTION.MOVE_HORIZONTALLY else self._vertical_target(contact)
        if autopilot.mode.number != _PLANE.AVOID_ADSB or (
            action == _ACTION.ASCEND_OR_DESCEND and down is None
        ):
            return False
        ahead, here = autopilot.target or autopilot.maneuvers.place, autopilot.maneuvers.place
        north, east = ahead[0], ahead[1]
        if action != _ACTION.ASCEND_OR_DESCEND:
            away = away_from(autopilot, contact)
            north, east = here[0] + _ASIDE * away[0], here[1] + _ASIDE * away[1]
        autopilot.guided.go_to((north, east, ahead[2] if down is None else down))
        return True

    def _vertical_target(self, contact: Contact) -> float | None:
        """Return the metres down to fly to; None if the plane is too low to descend."""
        autopilot = self._autopilot
        down = autopilot.maneuvers.place[2]
        if is_above(autopilot, contact):
            return down - _STEP
        return down + _STEP if autopilot.altitude > autopilot.flight_parameters.return_altitude else None

    def _hovers(self) -> bool:
        autopilot = self._autopilot
        return autopilot.vehicle.vehicle_type.name == "VTOL" and not autopilot.maneuvers.circles


def is_above(autopilot: SimulatedAutopilot, contact: Contact) -> bool:
    """Return whether a vehicle is higher than an aircraft."""
    return autopilot.body.estimate.down < contact.down


def away_from(autopilot: SimulatedAutopilot, contact: Contact) -> tuple[float, float]:
    """Return the direction (north, east; length 1) away from the course of an aircraft."""
    here = autopilot.body.estimate
    north, east = here.north - contact.north, here.east - contact.east
    squared = contact.velocity_north**2 + contact.velocity_east**2
    along = (north * contact.velocity_north + east * contact.velocity_east) / max(squared, 1.0)
    north, east = north - along * contact.velocity_north, east - along * contact.velocity_east
    # On a head-on course: move to the right, seen from the vehicle towards the aircraft.
    if hypot(north, east) < _RESTING:
        north, east = contact.velocity_east, -contact.velocity_north
    length = max(hypot(north, east), _RESTING)
    return north / length, east / length
