"""PX4's commands that fly: take-off, landing, return, going somewhere, orbits, speed, transitions.

Altitudes are above mean sea level, in whatever frame a command comes: PX4 does not look at it.
"""

from __future__ import annotations

from dataclasses import replace
from math import copysign, isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.commands import (
    CommandRefusedError,
    Handlers,
    MovementCommands,
    Outcome,
    has_place,
    number,
    place_of,
    whole,
)
from mavstack.sim.autopilot.commands.guiding import apply_choices
from mavstack.sim.autopilot.commands.places import GLOBAL
from mavstack.sim.px4.mode_selection import choose_mode
from mavstack.sim.px4.modes import HOLD, LAND, ORBIT, RETURN, TAKEOFF, VTOL_TAKEOFF
from mavstack.sim.px4.state import OrbitRequest
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.command import Command, CommandRequest
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.px4.state import Px4State

_CMD, _RESULT = common.MavCmd, common.MavResult
_CRITICAL = common.MavSeverity.CRITICAL
_STATE = common.MavVtolState
_CHANGE_MODE: Final = int(common.MavDoRepositionFlags.CHANGE_MODE)
_HIGHEST: Final = 1.0e5
_FASTEST: Final = 1000.0

#: Modes in which a VTOL refuses the transition to forward flight.
_HOVERING_MODES: Final = frozenset({TAKEOFF, LAND, RETURN, ORBIT})


class Px4Movement(MovementCommands):
    """With PX4's answers and words."""

    def __init__(self, vehicle: Vehicle, state: Px4State) -> None:
        super().__init__(vehicle)
        self._state = state

    def handlers(self) -> Handlers:
        handlers: dict[int, Callable[[CommandRequest], Outcome]] = {
            _CMD.NAV_RETURN_TO_LAUNCH: self.return_to_launch,
            _CMD.DO_REPOSITION: self.reposition,
            _CMD.DO_CHANGE_SPEED: self.change_speed,
        }
        if self.vehicle.type.flies:
            handlers |= {
                _CMD.NAV_TAKEOFF: self.take_off,
                _CMD.NAV_LAND: self.land,
                _CMD.DO_ORBIT: self.orbit,
                _CMD.DO_CHANGE_ALTITUDE: self.change_altitude,
                _CMD.DO_GO_AROUND: self.go_around,
            }
        if self.vehicle.type is VehicleType.VTOL:
            handlers |= {
                _CMD.NAV_VTOL_TAKEOFF: self.take_off_forward,
                _CMD.DO_VTOL_TRANSITION: self.change_over,
            }
        return handlers

    # Modes

    def enter(self, mode: int) -> common.MavResult:
        """Enter a mode, or say why not."""
        refused = choose_mode(self.vehicle, mode)
        if refused is not None:
            self.vehicle.send_statustext(refused, _CRITICAL)
            return _RESULT.TEMPORARILY_REJECTED
        return _RESULT.ACCEPTED

    def return_to_launch(self, request: CommandRequest) -> common.MavResult:
        """NAV_RETURN_TO_LAUNCH."""
        result = self.enter(RETURN)
        if result == _RESULT.ACCEPTED:
            self.vehicle.send_statustext("Returning to launch")
        return result

    def land(self, request: CommandRequest) -> common.MavResult:
        """NAV_LAND: here, whatever place the command names."""
        result = self.enter(LAND)
        if result == _RESULT.ACCEPTED:
            self.vehicle.send_statustext("Landing at current position")
        return result

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """NAV_TAKEOFF: to param 7 above the sea, or by MIS_TAKEOFF_ALT; it may come before arming."""
        return self._take_off(TAKEOFF, request.command.param7)

    def take_off_forward(self, request: CommandRequest) -> common.MavResult:
        """NAV_VTOL_TAKEOFF: the transition is at param 7 above the sea."""
        return self._take_off(VTOL_TAKEOFF, request.command.param7)

    def _take_off(self, mode: int, altitude: float) -> common.MavResult:
        before, self._state.takeoff_altitude = self._state.takeoff_altitude, altitude
        if abs(number(altitude)) > _HIGHEST:
            self._state.takeoff_altitude = before
            return _RESULT.DENIED
        return self.enter(mode)

    def go_around(self, request: CommandRequest) -> common.MavResult:
        """DO_GO_AROUND: a landing is given up; there must be one."""
        behaviour = self.autopilot.behaviour
        if behaviour is None or not behaviour.landing or self.autopilot.landed:
            return _RESULT.TEMPORARILY_REJECTED
        here = self.autopilot.maneuvers.stopping_point
        climb = float(self.vehicle.parameters["MIS_LND_ABRT_ALT"])
        up = min(here[2], self.autopilot.home_position[2] - climb)
        result = self.enter(HOLD)
        if result == _RESULT.ACCEPTED:
            self.autopilot.guided.go_to((here[0], here[1], up))
        return result

    # Going somewhere

    def reposition(self, request: CommandRequest) -> common.MavResult:
        """DO_REPOSITION: go there in Hold; what is left out stays as it is."""
        command = request.command
        point = self.target_place(command)
        if self.autopilot.mode.number != HOLD:
            if not (whole(command.param2) or 0) & _CHANGE_MODE:
                return _RESULT.DENIED
            result = self.enter(HOLD)
            if result != _RESULT.ACCEPTED:
                return result
        self.go_to(point, command)
        return _RESULT.ACCEPTED

    def target_place(self, command: Command) -> Point:
        """The place that a command wants to be gone to."""
        usual = replace(command, frame=common.MavFrame.GLOBAL)
        if command.frame is not None and command.frame not in GLOBAL:
            raise CommandRefusedError(_RESULT.COMMAND_UNSUPPORTED_MAV_FRAME)
        point = place_of(self.autopilot, usual)
        if has_place(command):
            return point
        autopilot = self.autopilot
        kept = autopilot.target if autopilot.mode.number == HOLD else None
        north, east, down = kept or autopilot.maneuvers.stopping_point
        return north, east, point[2] if isfinite(command.param7) else down

    def change_altitude(self, request: CommandRequest) -> common.MavResult:
        """DO_CHANGE_ALTITUDE: to param 1 above the sea, while it holds."""
        autopilot, altitude = self.autopilot, request.command.param1
        if autopilot.mode.number != HOLD:
            return _RESULT.TEMPORARILY_REJECTED
        if not abs(altitude) <= _HIGHEST:
            return _RESULT.DENIED
        north, east, _ = autopilot.target or autopilot.maneuvers.stopping_point
        autopilot.guided.go_to((north, east, autopilot.body.frame.altitude - altitude))
        return _RESULT.ACCEPTED

    def orbit(self, request: CommandRequest) -> common.MavResult:
        """DO_ORBIT: a wing circles in Hold, what hovers in a mode of its own."""
        command, autopilot = request.command, self.autopilot
        wanted = OrbitRequest.read(autopilot, command, self.target_place(command))
        if autopilot.maneuvers.circles:
            if choose_mode(self.vehicle, HOLD) is not None:
                return self._refuse_orbit()
            autopilot.guided.orbit(wanted.centre, wanted.radius)
            return _RESULT.ACCEPTED
        most = float(self.vehicle.parameters["MC_ORBIT_RAD_MAX"])
        if abs(wanted.radius) > most:
            self.vehicle.send_statustext("Orbit radius limit exceeded", _CRITICAL)
            wanted = replace(wanted, radius=copysign(most, wanted.radius))
        self._state.orbit = wanted
        return self._refuse_orbit() if choose_mode(self.vehicle, ORBIT) is not None else _RESULT.ACCEPTED

    def _refuse_orbit(self) -> common.MavResult:
        self.vehicle.send_statustext("Orbit command rejected", _CRITICAL)
        return _RESULT.TEMPORARILY_REJECTED

    # How

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """DO_CHANGE_SPEED: forward, up or down; without a speed the usual ones count again."""
        kind, speed = whole(number(request.command.param1)), number(request.command.param2)
        if speed > 0:
            return super().change_speed(request) if speed <= _FASTEST else _RESULT.DENIED
        maneuvers = self.autopilot.maneuvers
        if kind in (common.SpeedType.CLIMB_SPEED, common.SpeedType.DESCENT_SPEED):
            maneuvers.climb = maneuvers.sink = None
        else:
            maneuvers.speed = None
        apply_choices(self.autopilot)
        return _RESULT.ACCEPTED

    def change_over(self, request: CommandRequest) -> common.MavResult:
        """DO_VTOL_TRANSITION: between hovering and flying on the wing."""
        wanted, autopilot = whole(number(request.command.param1)), self.autopilot
        if wanted not in (_STATE.MC, _STATE.FW):
            return _RESULT.DENIED
        changed = change_over(autopilot.vehicle, wanted == _STATE.FW)
        return _RESULT.ACCEPTED if changed else _RESULT.TEMPORARILY_REJECTED


def change_over(vehicle: Vehicle, forward: bool) -> bool:
    """Have a VTOL fly on its wing or hover, in the air; whether it may now."""
    autopilot = vehicle.autopilot
    denied = forward and autopilot.mode.number in _HOVERING_MODES
    if vehicle.type is not VehicleType.VTOL or denied or not autopilot.armed or autopilot.landed:
        return False
    autopilot.body.transition_to(forward)
    if autopilot.mission.flying:
        autopilot.mission.keep_course()
    else:
        autopilot.restart_behaviour()
    return True
