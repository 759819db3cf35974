"""ArduPilot's flight commands, and the refusals of each firmware.

An unknown frame is DENIED, and so is DO_REPOSITION outside GUIDED without its flag; as COMMAND_LONG, which
has no frame, it is UNSUPPORTED. Copter takes off in GUIDED, armed and landed; Plane only on its lifting
motors; Rover has no altitude.
"""

from __future__ import annotations

from math import cos, isfinite, pi, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.follow import choose_leader
from mavstack.sim.autopilot.command_positions import ABOVE_HOME, GLOBAL, down_of, place_of
from mavstack.sim.autopilot.commands import CommandRefusedError, Handlers, MovementCommands, accept, whole
from mavstack.sim.autopilot.commands.guiding import apply_choices, guide_to

if TYPE_CHECKING:
    from mavstack.services.command import Command, CommandRequest
    from mavstack.sim.autopilot.maneuvers import Point

_CMD, _RESULT = ardupilotmega.MavCmd, common.MavResult
_VTOL = common.MavVtolState
_MAX_ALTITUDE: Final = 83_000.0
#: A guided heading is flown as a line to a point this many metres ahead.
_FAR_AHEAD: Final = 100_000.0
#: The first version of ArduPlane that reads a radius from DO_REPOSITION.
_WITH_RADIUS: Final = (4, 3)
_MAX_SYSTEM: Final = 255
#: The heading type HEADING_TYPE_DEFAULT.
_HEADING_DEFAULT: Final = 2


class ArdupilotMovement(MovementCommands):
    """Flight commands of all types."""

    bad_frame = _RESULT.DENIED

    def handlers(self) -> Handlers:
        return {
            _CMD.NAV_RETURN_TO_LAUNCH: self.return_to_launch,
            _CMD.DO_REPOSITION: self.reposition,
            _CMD.DO_CHANGE_SPEED: self.change_speed,
        }

    @property
    def in_guided(self) -> bool:
        """True in GUIDED mode."""
        return self.autopilot.mode.number == self.autopilot.profile.guided

    def reposition(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_REPOSITION, which must be a COMMAND_INT."""
        return _RESULT.UNSUPPORTED if request.command.frame is None else super().reposition(request)

    def target_place(self, command: Command) -> Point:
        """Return the local point of a command; an altitude is required."""
        if not isfinite(command.param7) or abs(command.param7) > _MAX_ALTITUDE:
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
            _CMD.DO_FOLLOW: self.choose_leader,
        }

    def choose_leader(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_FOLLOW: the system of param1 is the one that FOLLOW follows; the mode stays."""
        system = whole(request.command.param1)
        if system is None or not 0 <= system <= _MAX_SYSTEM:
            return _RESULT.DENIED
        choose_leader(self.vehicle, system)
        return _RESULT.ACCEPTED

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_TAKEOFF: in GUIDED, armed, landed and upwards; otherwise FAILED."""
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
        """Answer CONDITION_YAW; invalid values answer FAILED."""
        result = super().turn(request)
        return _RESULT.FAILED if result == _RESULT.DENIED else result

    def go_to(self, point: Point, command: Command) -> None:
        """Fly to a point; other fields are ignored."""
        guide_to(self.autopilot, point)


class PlaneMovement(ArdupilotMovement):
    """ArduPlane: param3 of DO_REPOSITION is the radius, the sign of param4 the direction."""

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
        """Circle a point; before 4.3 with WP_LOITER_RAD."""
        radius = command.param3 if isfinite(command.param3) and command.param3 > 0 else None
        if self.autopilot.profile.version[:2] < _WITH_RADIUS:
            radius = self.autopilot.flight_parameters.loiter_radius
        if radius is not None and isfinite(command.param4) and command.param4 != 0:
            radius = -abs(radius)
        guide_to(self.autopilot, point, radius=radius)

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_TAKEOFF with FAILED: a plane takes off in TAKEOFF or AUTO only."""
        return _RESULT.FAILED

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_CHANGE_SPEED: in GUIDED and AUTO, within the airspeed limits."""
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
        """Answer GUIDED_CHANGE_SPEED: airspeed only."""
        command = self._guided(request)
        if whole(command.param1) != common.SpeedType.AIRSPEED:
            return _RESULT.DENIED
        if not self._can_fly(command.param2):
            return _RESULT.FAILED
        self.autopilot.maneuvers.speed = command.param2
        apply_choices(self.autopilot)
        return _RESULT.ACCEPTED

    def change_guided_altitude(self, request: CommandRequest) -> common.MavResult:
        """Answer GUIDED_CHANGE_ALTITUDE: param7 in its frame, at param3 m/s."""
        command = self._guided(request)
        if command.param7 in (-1.0, 0.0) or not isfinite(command.param7):
            return _RESULT.DENIED
        if command.frame not in GLOBAL:
            return _RESULT.DENIED
        rate = abs(command.param3) if isfinite(command.param3) else 0.0
        self.autopilot.maneuvers.climb = self.autopilot.maneuvers.sink = rate or None
        north, east, _ = self.autopilot.target or self.autopilot.maneuvers.place
        down = down_of(self.autopilot, command.param7, command.frame, (north, east))
        guide_to(self.autopilot, (north, east, down))
        return _RESULT.ACCEPTED

    def change_guided_heading(self, request: CommandRequest) -> common.MavResult:
        """Answer GUIDED_CHANGE_HEADING: fly on at param2 degrees."""
        command = self._guided(request)
        if not 0.0 <= command.param2 < 360.0:
            return _RESULT.DENIED
        heading_type = whole(command.param1)
        if heading_type not in (0, 1, _HEADING_DEFAULT):
            return _RESULT.DENIED
        if heading_type != _HEADING_DEFAULT:
            course = radians(command.param2)
            guide_to(self.autopilot, self.autopilot.maneuvers.ahead(_FAR_AHEAD, course))
        return _RESULT.ACCEPTED

    def _guided(self, request: CommandRequest) -> Command:
        """Return the command; refuse it outside GUIDED."""
        if not self.in_guided:
            raise CommandRefusedError(_RESULT.FAILED)
        return request.command

    def _can_fly(self, airspeed: float) -> bool:
        """Return whether an airspeed is within the limits."""
        parameters = self.vehicle.parameters
        return float(parameters["AIRSPEED_MIN"]) <= airspeed <= float(parameters["AIRSPEED_MAX"])


class QuadplaneMovement(PlaneMovement):
    """ArduPlane with lifting motors."""

    def handlers(self) -> Handlers:
        return {**super().handlers(), _CMD.DO_VTOL_TRANSITION: self.transition}

    def take_off(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_TAKEOFF: straight up in GUIDED; a COMMAND_INT must be LOCAL_OFFSET_NED."""
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
        """Answer DO_VTOL_TRANSITION: to hover or forward flight, in the air."""
        requested = whole(request.command.param1)
        profile = self.autopilot.profile
        controlled = self.autopilot.mode.number in (profile.guided, profile.mission)
        if requested not in (_VTOL.MC, _VTOL.FW) or not controlled or self.autopilot.landed:
            return _RESULT.FAILED
        self._start_transition(forward=requested == _VTOL.FW)
        return _RESULT.ACCEPTED

    def go_to(self, point: Point, command: Command) -> None:
        """Fly to a point on the wing, unless Q_GUIDED_MODE selects hover."""
        if not int(self.vehicle.parameters["Q_GUIDED_MODE"]) and not self.autopilot.landed:
            self.autopilot.body.transition_to(True)
        super().go_to(point, command)

    def _start_transition(self, *, forward: bool) -> None:
        """Start a transition and continue the flight."""
        autopilot = self.autopilot
        autopilot.body.transition_to(forward)
        if autopilot.mission.flying:
            autopilot.mission.hovers = not forward
            autopilot.mission.course.keep(again=True)
        else:
            place = autopilot.maneuvers.place if forward else autopilot.maneuvers.stopping_point
            guide_to(autopilot, place)


class RoverMovement(ArdupilotMovement):
    """Rovers and boats."""

    def handlers(self) -> Handlers:
        return {**super().handlers(), _CMD.NAV_SET_YAW_SPEED: self.steer}

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_CHANGE_SPEED: ground speed, in automatic modes."""
        if whole(request.command.param1) not in (common.SpeedType.AIRSPEED, common.SpeedType.GROUNDSPEED):
            return _RESULT.DENIED
        if self.autopilot.mode.manual_control or not request.command.param2 > 0:
            return _RESULT.FAILED
        return super().change_speed(request)

    def go_to(self, point: Point, command: Command) -> None:
        """Drive to a point at the speed of param1."""
        speed = command.param1 if isfinite(command.param1) and command.param1 > 0 else None
        guide_to(self.autopilot, (point[0], point[1], 0.0), speed=speed)

    def steer(self, request: CommandRequest) -> common.MavResult:
        """Answer NAV_SET_YAW_SPEED: a heading in degrees, absolute or relative, and a speed."""
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
    """ArduSub: landing is surfacing, and there is no return."""

    def handlers(self) -> Handlers:
        return {
            _CMD.DO_REPOSITION: self.reposition,
            _CMD.DO_CHANGE_SPEED: self.change_speed,
            _CMD.NAV_LOITER_UNLIM: self.loiter,
            _CMD.NAV_LAND: self.land,
            _CMD.CONDITION_YAW: self.turn,
        }

    def change_speed(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_CHANGE_SPEED: speed through the water."""
        if whole(request.command.param1) not in (common.SpeedType.AIRSPEED, common.SpeedType.GROUNDSPEED):
            return _RESULT.DENIED
        return super().change_speed(request)

    def go_to(self, point: Point, command: Command) -> None:
        """Go to a point below the surface."""
        guide_to(self.autopilot, (point[0], point[1], max(point[2], 0.0)))
