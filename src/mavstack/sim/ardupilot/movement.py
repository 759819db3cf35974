"""Where ArduPilot's vehicles go when they are told to, and what each firmware refuses.

A frame that means nothing is DENIED, and so is DO_REPOSITION outside GUIDED without its flag; as COMMAND_LONG
it is UNSUPPORTED, since no frame can be told. Copter takes off in GUIDED, armed and landed; Plane only on its
lifting motors; Rover has no altitude to leave.
"""

from __future__ import annotations

from math import cos, isfinite, pi, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.autopilot.commands import CommandRefusedError, Handlers, MovementCommands, accept, whole
from mavstack.sim.autopilot.commands.guiding import fly_as_chosen, guide_to
from mavstack.sim.autopilot.commands.places import ABOVE_HOME, GLOBAL, down_of, place_of

if TYPE_CHECKING:
    from mavstack.services.command import Command, CommandRequest
    from mavstack.sim.autopilot.maneuvers import Point

_CMD, _RESULT = ardupilotmega.MavCmd, common.MavResult
_VTOL = common.MavVtolState
_HIGHEST: Final = 83_000.0
_AHEAD: Final = 100_000.0
#: HEADING_TYPE_DEFAULT.
_AS_IT_FLIES: Final = 2


class ArdupilotMovement(MovementCommands):
    """What all of ArduPilot's vehicles have in common."""

    bad_frame = _RESULT.DENIED

    def handlers(self) -> Handlers:
        return {
            _CMD.NAV_RETURN_TO_LAUNCH: self.return_to_launch,
            _CMD.DO_REPOSITION: self.reposition,
            _CMD.DO_CHANGE_SPEED: self.change_speed,
        }

    @property
    def in_guided(self) -> bool:
        """Whether it flies to what it is told."""
        return self.autopilot.mode.number == self.autopilot.profile.guided

    def reposition(self, request: CommandRequest) -> common.MavResult:
        """DO_REPOSITION, which must come as COMMAND_INT."""
        return _RESULT.UNSUPPORTED if request.command.frame is None else super().reposition(request)

    def wanted_place(self, command: Command) -> Point:
        """The place in a command; an altitude must be there."""
        if not isfinite(command.param7) or abs(command.param7) > _HIGHEST:
            raise CommandRefusedError(_RESULT.DENIED)
        return place_of(self.autopilot, command, frames=GLOBAL, bad_frame=self.bad_frame)


class CopterMovement(ArdupilotMovement):
    """ArduCopter."""

    def handlers(self) -> Handlers:
        return {
            **super().handlers(),
            _CMD.NAV_TAKEOFF: self.take_off,
            _CMD.NAV_VTOL_TAKEOFF: self.take_off,
            _CMD.NAV_LOITER_UNLIM: self.loiter,
            _CMD.NAV_LAND: self.land,
            _CMD.NAV_VTOL_LAND: self.land,
            _CMD.CONDITION_YAW: self.turn,
        }

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """NAV_TAKEOFF: in GUIDED, armed, on the ground, upwards; anything else FAILED."""
        command, autopilot = request.command, self.autopilot
        if command.frame is not None and command.frame not in ABOVE_HOME:
            return _RESULT.DENIED
        altitude = command.param7
        ready = autopilot.armed and autopilot.landed and self.in_guided
        if not ready or not isfinite(altitude) or altitude <= autopilot.altitude:
            return _RESULT.FAILED
        autopilot.guided.take_off(down=down_of(autopilot, altitude, common.MavFrame.GLOBAL_RELATIVE_ALT))
        return _RESULT.ACCEPTED

    def turn(self, request: CommandRequest) -> common.MavResult:
        """CONDITION_YAW; what it cannot mean FAILED."""
        result = super().turn(request)
        return _RESULT.FAILED if result == _RESULT.DENIED else result

    def go_to(self, point: Point, command: Command) -> None:
        """Only the place counts."""
        guide_to(self.autopilot, point)


class PlaneMovement(ArdupilotMovement):
    """ArduPlane: param 3 of DO_REPOSITION is the radius, the sign of param 4 the direction."""

    def handlers(self) -> Handlers:
        return {
            **super().handlers(),
            _CMD.NAV_LOITER_UNLIM: self.loiter,
            _CMD.NAV_TAKEOFF: self.take_off,
            _CMD.GUIDED_CHANGE_SPEED: self.change_guided_speed,
            _CMD.GUIDED_CHANGE_ALTITUDE: self.change_guided_altitude,
            _CMD.GUIDED_CHANGE_HEADING: self.change_guided_heading,
        }

    def go_to(self, point: Point, command: Command) -> None:
        """Circle it."""
        radius = command.param3 if isfinite(command.param3) and command.param3 > 0 else None
        if radius is not None and isfinite(command.param4) and command.param4 != 0:
            radius = -radius
        guide_to(self.autopilot, point, radius=radius)

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """NAV_TAKEOFF: a plane takes off in TAKEOFF or AUTO, not by command."""
        return _RESULT.FAILED

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """DO_CHANGE_SPEED: only while the autopilot flies; the airspeed must be one that can be flown."""
        profile, number = self.autopilot.profile, self.autopilot.mode.number
        if number not in (profile.guided, profile.mission):
            return _RESULT.FAILED
        if whole(request.command.param1) == common.SpeedType.AIRSPEED and not self._can_fly(
            request.command.param2
        ):
            return _RESULT.FAILED
        result = super().change_speed(request)
        return accept(result == _RESULT.ACCEPTED)

    def change_guided_speed(self, request: CommandRequest) -> common.MavResult:
        """GUIDED_CHANGE_SPEED: airspeed only."""
        command = self._guided(request)
        if whole(command.param1) != common.SpeedType.AIRSPEED:
            return _RESULT.DENIED
        if not self._can_fly(command.param2):
            return _RESULT.FAILED
        self.autopilot.maneuvers.speed = command.param2
        fly_as_chosen(self.autopilot)
        return _RESULT.ACCEPTED

    def change_guided_altitude(self, request: CommandRequest) -> common.MavResult:
        """GUIDED_CHANGE_ALTITUDE: param 7 in its frame, at a rate of param 3 metres a second."""
        command = self._guided(request)
        if command.param7 in (-1.0, 0.0) or not isfinite(command.param7):
            return _RESULT.DENIED
        if command.frame not in GLOBAL:
            return _RESULT.DENIED
        rate = abs(command.param3) if isfinite(command.param3) else 0.0
        self.autopilot.maneuvers.climb = self.autopilot.maneuvers.sink = rate or None
        north, east, _ = self.autopilot.target or self.autopilot.maneuvers.place
        guide_to(self.autopilot, (north, east, down_of(self.autopilot, command.param7, command.frame)))
        return _RESULT.ACCEPTED

    def change_guided_heading(self, request: CommandRequest) -> common.MavResult:
        """GUIDED_CHANGE_HEADING: fly on at param 2 degrees."""
        command = self._guided(request)
        if not 0.0 <= command.param2 < 360.0:
            return _RESULT.DENIED
        kind = whole(command.param1)
        if kind not in (0, 1, _AS_IT_FLIES):
            return _RESULT.DENIED
        if kind != _AS_IT_FLIES:
            course = radians(command.param2)
            guide_to(self.autopilot, self.autopilot.maneuvers.ahead(_AHEAD, course))
        return _RESULT.ACCEPTED

    def _guided(self, request: CommandRequest) -> Command:
        if not self.in_guided:
            raise CommandRefusedError(_RESULT.FAILED)
        return request.command

    def _can_fly(self, airspeed: float) -> bool:
        flight_parameters = self.vehicle.parameters
        return (
            float(flight_parameters["AIRSPEED_MIN"]) <= airspeed <= float(flight_parameters["AIRSPEED_MAX"])
        )


class QuadplaneMovement(PlaneMovement):
    """ArduPlane with lifting motors."""

    def handlers(self) -> Handlers:
        return {**super().handlers(), _CMD.DO_VTOL_TRANSITION: self.transition}

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """NAV_TAKEOFF: straight up in GUIDED; as COMMAND_INT only in the frame LOCAL_OFFSET_NED."""
        command, autopilot = request.command, self.autopilot
        climb = command.param7
        if command.frame is not None:
            if command.frame != common.MavFrame.LOCAL_OFFSET_NED:
                return _RESULT.DENIED
            climb = -climb
        if not self.in_guided:
            raise CommandRefusedError(_RESULT.FAILED, "User Takeoff only in GUIDED mode")
        if not autopilot.armed:
            raise CommandRefusedError(_RESULT.FAILED, "Must be armed for takeoff")
        if not autopilot.landed:
            raise CommandRefusedError(_RESULT.FAILED, "Already flying - no takeoff")
        if not isfinite(climb) or climb <= 0:
            return _RESULT.FAILED
        autopilot.guided.take_off(climb)
        return _RESULT.ACCEPTED

    def transition(self, request: CommandRequest) -> common.MavResult:
        """DO_VTOL_TRANSITION: to hover, or to forward flight, while it is in the air."""
        wanted = whole(request.command.param1)
        profile = self.autopilot.profile
        automatic = self.autopilot.mode.number in (profile.guided, profile.mission)
        if wanted not in (_VTOL.MC, _VTOL.FW) or not automatic or self.autopilot.landed:
            return _RESULT.FAILED
        self._become(forward=wanted == _VTOL.FW)
        return _RESULT.ACCEPTED

    def go_to(self, point: Point, command: Command) -> None:
        """On the wing, unless Q_GUIDED_MODE says to hover there."""
        if not int(self.vehicle.parameters["Q_GUIDED_MODE"]) and not self.autopilot.landed:
            self.autopilot.body.transition_to(True)
        super().go_to(point, command)

    def _become(self, *, forward: bool) -> None:
        autopilot = self.autopilot
        autopilot.body.transition_to(forward)
        if autopilot.mission.flying:
            autopilot.mission.hovers = not forward
            autopilot.mission.course.keep(again=True)
        else:
            place = autopilot.maneuvers.place if forward else autopilot.maneuvers.stopping_point
            guide_to(autopilot, place)


class RoverMovement(ArdupilotMovement):
    """Rover on wheels and afloat."""

    def handlers(self) -> Handlers:
        return {**super().handlers(), _CMD.NAV_SET_YAW_SPEED: self.steer}

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """DO_CHANGE_SPEED: over ground, while the autopilot drives."""
        if whole(request.command.param1) not in (common.SpeedType.AIRSPEED, common.SpeedType.GROUNDSPEED):
            return _RESULT.DENIED
        if self.autopilot.mode.manual_control or not request.command.param2 > 0:
            return _RESULT.FAILED
        return super().change_speed(request)

    def go_to(self, point: Point, command: Command) -> None:
        """There, on the ground, at the speed of param 1."""
        speed = command.param1 if isfinite(command.param1) and command.param1 > 0 else None
        guide_to(self.autopilot, (point[0], point[1], 0.0), speed=speed)

    def steer(self, request: CommandRequest) -> common.MavResult:
        """NAV_SET_YAW_SPEED: a heading in degrees, absolute or relative, and a speed."""
        command = request.command
        if not self.in_guided:
            return _RESULT.FAILED
        if not (isfinite(command.param1) and isfinite(command.param2)):
            return _RESULT.DENIED
        heading = radians(command.param1) % (2 * pi)
        if command.param3 > 0:
            heading += self.autopilot.body.estimate.yaw
        speed = command.param2
        self.autopilot.guided.fly_velocity(cos(heading) * speed, sin(heading) * speed, 0.0, yaw=heading)
        return _RESULT.ACCEPTED


class SubMovement(ArdupilotMovement):
    """ArduSub: landing is surfacing, and there is no way home."""

    def handlers(self) -> Handlers:
        return {
            _CMD.DO_REPOSITION: self.reposition,
            _CMD.DO_CHANGE_SPEED: self.change_speed,
            _CMD.NAV_LOITER_UNLIM: self.loiter,
            _CMD.NAV_LAND: self.land,
            _CMD.CONDITION_YAW: self.turn,
        }

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """DO_CHANGE_SPEED: through the water."""
        if whole(request.command.param1) not in (common.SpeedType.AIRSPEED, common.SpeedType.GROUNDSPEED):
            return _RESULT.DENIED
        return super().change_speed(request)

    def go_to(self, point: Point, command: Command) -> None:
        """There, and not above the water."""
        guide_to(self.autopilot, (point[0], point[1], max(point[2], 0.0)))
