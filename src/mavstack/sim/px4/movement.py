"""PX4's flight commands: take-off, landing, return, reposition, orbits, speed, transitions.

Altitudes are above mean sea level in every frame, because PX4 ignores the frame.
"""

from __future__ import annotations

from dataclasses import replace
from math import copysign, isfinite, nan
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.command_positions import GLOBAL
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
from mavstack.sim.px4.mode_selection import choose_mode
from mavstack.sim.px4.modes import HOLD, LAND, ORBIT, RETURN, TAKEOFF, VTOL_TAKEOFF
from mavstack.sim.px4.state import OrbitRequest
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.command import Command, CommandRequest
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.px4.state import Px4State
    from mavstack.sim.vehicle import SimulatedVehicle

_CMD, _RESULT = common.MavCmd, common.MavResult
_CRITICAL = common.MavSeverity.CRITICAL
_STATE = common.MavVtolState
_CHANGE_MODE: Final = int(common.MavDoRepositionFlags.CHANGE_MODE)
_MAX_ALTITUDE: Final = 1.0e5
_MAX_SPEED: Final = 1000.0

#: Modes in which a VTOL refuses the transition to forward flight.
_HOVERING_MODES: Final = frozenset({TAKEOFF, LAND, RETURN, ORBIT})


class Px4Movement(MovementCommands):
    """Flight commands with PX4's answers and status texts."""

    def __init__(self, vehicle: SimulatedVehicle, state: Px4State) -> None:
        super().__init__(vehicle)
        self._state = state

    def handlers(self) -> Handlers:
        handlers: dict[int, Callable[[CommandRequest], Outcome]] = {
            _CMD.NAV_RETURN_TO_LAUNCH: self.return_to_launch,
            _CMD.DO_REPOSITION: self.reposition,
            _CMD.DO_CHANGE_SPEED: self.change_speed,
        }
        if self.vehicle.vehicle_type.flies:
            handlers |= {
                _CMD.NAV_TAKEOFF: self.take_off,
                _CMD.NAV_LAND: self.land,
                _CMD.DO_ORBIT: self.orbit,
                _CMD.DO_CHANGE_ALTITUDE: self.change_altitude,
                _CMD.DO_GO_AROUND: self.go_around,
            }
        if self.vehicle.vehicle_type is VehicleType.VTOL:
            handlers |= {
                _CMD.NAV_VTOL_TAKEOFF: self.take_off_forward,
                _CMD.DO_VTOL_TRANSITION: self.start_transition,
            }
        return handlers

    # Modes

    def enter(self, mode: int) -> common.MavResult:
        """Enter a mode, or report why not."""
        refused = choose_mode(self.vehicle, mode)
        if refused is not None:
            self.vehicle.send_statustext(refused, _CRITICAL)
            return _RESULT.TEMPORARILY_REJECTED
        return _RESULT.ACCEPTED

    def return_to_launch(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_RETURN_TO_LAUNCH."""
        result = self.enter(RETURN)
        if result == _RESULT.ACCEPTED:
            self.vehicle.send_statustext("Returning to launch")
        return result

    def land(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_LAND: land at the present position; the command's position is ignored."""
        result = self.enter(LAND)
        if result == _RESULT.ACCEPTED:
            self.vehicle.send_statustext("Landing at current position")
        return result

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_TAKEOFF: to param7 above mean sea level, or by MIS_TAKEOFF_ALT."""
        return self._take_off(TAKEOFF, request.command.param7)

    def take_off_forward(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_VTOL_TAKEOFF: the transition is at param7 above mean sea level."""
        return self._take_off(VTOL_TAKEOFF, request.command.param7)

    def _take_off(self, mode: int, altitude: float) -> common.MavResult:
        """Enter a take-off mode with an altitude."""
        before, self._state.takeoff_altitude = self._state.takeoff_altitude, altitude
        if abs(number(altitude)) > _MAX_ALTITUDE:
            self._state.takeoff_altitude = before
            return _RESULT.DENIED
        return self.enter(mode)

    def go_around(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_GO_AROUND: abort a landing."""
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

    # Positions

    def reposition(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_REPOSITION: fly to a point in Hold; fields left out keep their values."""
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

    def go_to(self, point: Point, command: Command) -> None:
        """Go to a point; the radius is ignored: a wing circles with NAV_LOITER_RAD."""
        super().go_to(point, replace(command, param3=nan))

    def target_place(self, command: Command) -> Point:
        """Return the local point that a command names."""
        in_global_frame = replace(command, frame=common.MavFrame.GLOBAL)
        if command.frame is not None and command.frame not in GLOBAL:
            raise CommandRefusedError(_RESULT.COMMAND_UNSUPPORTED_MAV_FRAME)
        point = place_of(self.autopilot, in_global_frame)
        if has_place(command):
            return point
        autopilot = self.autopilot
        kept = autopilot.target if autopilot.mode.number == HOLD else None
        north, east, down = kept or autopilot.maneuvers.stopping_point
        return north, east, point[2] if isfinite(command.param7) else down

    def change_altitude(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_CHANGE_ALTITUDE: to param1 above mean sea level, in Hold only."""
        autopilot, altitude = self.autopilot, request.command.param1
        if autopilot.mode.number != HOLD:
            return _RESULT.TEMPORARILY_REJECTED
        if not abs(altitude) <= _MAX_ALTITUDE:
            return _RESULT.DENIED
        north, east, _ = autopilot.target or autopilot.maneuvers.stopping_point
        autopilot.guided.go_to((north, east, autopilot.body.frame.altitude - altitude))
        return _RESULT.ACCEPTED

    def orbit(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_ORBIT: a wing circles in Hold, other types in Orbit."""
        command, autopilot = request.command, self.autopilot
        requested = OrbitRequest.read(autopilot, command, self.target_place(command))
        if autopilot.maneuvers.circles:
            if choose_mode(self.vehicle, HOLD) is not None:
                return self._refuse_orbit()
            autopilot.guided.orbit(requested.centre, requested.radius)
            return _RESULT.ACCEPTED
        max_radius = float(self.vehicle.parameters["MC_ORBIT_RAD_MAX"])
        if abs(requested.radius) > max_radius:
            self.vehicle.send_statustext("Orbit radius limit exceeded", _CRITICAL)
            requested = replace(requested, radius=copysign(max_radius, requested.radius))
        self._state.orbit = requested
        return self._refuse_orbit() if choose_mode(self.vehicle, ORBIT) is not None else _RESULT.ACCEPTED

    def _refuse_orbit(self) -> common.MavResult:
        """Reject an orbit."""
        self.vehicle.send_statustext("Orbit command rejected", _CRITICAL)
        return _RESULT.TEMPORARILY_REJECTED

    # Speed and transitions

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_CHANGE_SPEED: forward, up or down; no speed restores the defaults."""
        kind, speed = whole(number(request.command.param1)), number(request.command.param2)
        if speed > 0:
            return super().change_speed(request) if speed <= _MAX_SPEED else _RESULT.DENIED
        maneuvers = self.autopilot.maneuvers
        if kind in (common.SpeedType.CLIMB_SPEED, common.SpeedType.DESCENT_SPEED):
            maneuvers.climb = maneuvers.sink = None
        else:
            maneuvers.speed = None
        apply_choices(self.autopilot)
        return _RESULT.ACCEPTED

    def start_transition(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_VTOL_TRANSITION: between hover and forward flight."""
        requested, autopilot = whole(number(request.command.param1)), self.autopilot
        if requested not in (_STATE.MC, _STATE.FW):
            return _RESULT.DENIED
        changed = start_transition(autopilot.vehicle, requested == _STATE.FW)
        return _RESULT.ACCEPTED if changed else _RESULT.TEMPORARILY_REJECTED


def start_transition(vehicle: SimulatedVehicle, forward: bool) -> bool:
    """Start a VTOL's transition in the air; return whether it is allowed."""
    autopilot = vehicle.autopilot
    denied = forward and autopilot.mode.number in _HOVERING_MODES
    if vehicle.vehicle_type is not VehicleType.VTOL or denied or not autopilot.armed or autopilot.landed:
        return False
    autopilot.body.transition_to(forward)
    if autopilot.mission.flying:
        autopilot.mission.keep_course()
    else:
        autopilot.restart_behaviour()
    return True
