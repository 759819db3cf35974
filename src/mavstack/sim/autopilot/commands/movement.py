"""Commands of destination and speed."""

from __future__ import annotations

from math import isfinite, radians
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.command_positions import GLOBAL, place_of
from mavstack.sim.autopilot.commands.guiding import apply_choices, guide_to
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, required_whole, whole
from mavstack.sim.autopilot.refusal import CommandRefusedError

if TYPE_CHECKING:
    from mavstack.services.command import Command, CommandRequest
    from mavstack.sim.autopilot.maneuvers import Point

_CMD, _RESULT = common.MavCmd, common.MavResult
_CHANGE_MODE = int(common.MavDoRepositionFlags.CHANGE_MODE)
_FASTEST = 1000.0
_WIDEST = 100_000.0


class MovementCommands(CommandGroup):
    """Modes by command, DO_REPOSITION, speed and yaw."""

    #: The command result if the frame is not supported.
    bad_frame = _RESULT.COMMAND_UNSUPPORTED_MAV_FRAME

    def handlers(self) -> Handlers:
        return {
            _CMD.NAV_RETURN_TO_LAUNCH: self.return_to_launch,
            _CMD.NAV_LOITER_UNLIM: self.loiter,
            _CMD.NAV_LAND: self.land,
            _CMD.DO_REPOSITION: self.reposition,
            _CMD.DO_CHANGE_SPEED: self.change_speed,
            _CMD.CONDITION_YAW: self.turn,
        }

    def return_to_launch(self, request: CommandRequest) -> common.MavResult:
        """NAV_RETURN_TO_LAUNCH."""
        return self.enter(self.autopilot.profile.return_to_launch)

    def loiter(self, request: CommandRequest) -> common.MavResult:
        """NAV_LOITER_UNLIM: stay here."""
        return self.enter(self.autopilot.profile.hold)

    def land(self, request: CommandRequest) -> common.MavResult:
        """NAV_LAND: land here."""
        return self.enter(self.autopilot.profile.land)

    # Destination

    def reposition(self, request: CommandRequest) -> common.MavResult:
        """DO_REPOSITION: go to params 5 to 7, in guided flight."""
        command = request.command
        point = self.target_place(command)
        self.enter_guided(command)
        self.go_to(point, command)
        return _RESULT.ACCEPTED

    def target_place(self, command: Command) -> Point:
        """Return the destination of a command."""
        return place_of(self.autopilot, command, frames=GLOBAL, bad_frame=self.bad_frame)

    def enter_guided(self, command: Command) -> None:
        """Enter the guided mode if the flags of param 2 allow it; else raise CommandRefusedError."""
        guided = self.autopilot.profile.guided
        if self.autopilot.mode.number == guided:
            return
        if not (whole(command.param2) or 0) & _CHANGE_MODE:
            raise CommandRefusedError(_RESULT.DENIED)
        if self.enter(guided) != _RESULT.ACCEPTED:
            raise CommandRefusedError(_RESULT.FAILED)

    def go_to(self, point: Point, command: Command) -> None:
        """Go to a point with the speed, radius and yaw of the command, where it has any."""
        speed = command.param1 if 0 < command.param1 <= _FASTEST else None
        radius = command.param3 if 0 < abs(command.param3) <= _WIDEST else None
        yaw = command.param4 if isfinite(command.param4) else None
        guide_to(self.autopilot, point, speed=speed, radius=radius, yaw=yaw)

    # Speed and yaw

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """DO_CHANGE_SPEED: over ground or through the air (both alike), up, down."""
        kind, speed = whole(request.command.param1), request.command.param2
        if not 0 < speed <= _FASTEST:
            return _RESULT.DENIED
        maneuvers = self.autopilot.maneuvers
        match kind:
            case common.SpeedType.AIRSPEED | common.SpeedType.GROUNDSPEED:
                maneuvers.speed = speed
            case common.SpeedType.CLIMB_SPEED:
                maneuvers.climb = speed
            case common.SpeedType.DESCENT_SPEED:
                maneuvers.sink = speed
            case _:
                return _RESULT.DENIED
        apply_choices(self.autopilot)
        return _RESULT.ACCEPTED

    def turn(self, request: CommandRequest) -> common.MavResult:
        """CONDITION_YAW: turn to param 1 degrees from north, or by that angle."""
        command = request.command
        angle, relative = command.param1, required_whole(command.param4)
        if not 0.0 <= angle <= 360.0 or relative not in (0, 1):
            return _RESULT.DENIED
        yaw = radians(angle)
        if relative:
            yaw = self.autopilot.body.estimate.yaw + (-yaw if command.param3 < 0 else yaw)
        self.autopilot.maneuvers.yaw = yaw
        apply_choices(self.autopilot)
        return _RESULT.ACCEPTED
