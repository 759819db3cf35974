"""ArduPilot's commands and their answers, by vehicle type.

Most commands are shared with PX4; here and in `movement.py` are those that ArduPilot answers differently. The
server answers unregistered commands with UNSUPPORTED.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import ardupilotmega, common, development
from mavstack.sim.ardupilot.arming import prearm_problems
from mavstack.sim.ardupilot.behaviours import land_by_mission
from mavstack.sim.ardupilot.calibration import ArdupilotMaintenance
from mavstack.sim.ardupilot.identity import banner_of
from mavstack.sim.ardupilot.movement import (
    ArdupilotMovement,
    CopterMovement,
    PlaneMovement,
    QuadplaneMovement,
    RoverMovement,
    SubMovement,
)
from mavstack.sim.ardupilot.switches import use_auxiliary_function
from mavstack.sim.autopilot.commands import (
    ArmingCommands,
    CameraCommands,
    CommandGroup,
    CommandRefusedError,
    EquipmentCommands,
    GimbalCommands,
    Handlers,
    HomeCommands,
    MissionCommands,
    Outcome,
    accept,
    has_place,
    place_of,
    register_handlers,
    whole,
)
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services.command import CommandRequest
    from mavstack.sim.vehicle import SimulatedVehicle

_CMD, _RESULT = ardupilotmega.MavCmd, common.MavResult
_INFO = common.MavSeverity.INFO
#: A second value of param 2 of COMPONENT_ARM_DISARM that forces arming, besides 21196.
_FORCE_ARMING = 2989.0
_MAX_SOURCES = 3
Handler: TypeAlias = "Callable[[CommandRequest], Outcome]"
#: Commands that are not supported, because ArduPilot has no standard modes.
_UNSUPPORTED = (_CMD.DO_SET_STANDARD_MODE,)
#: The parameter that enables a payload, by the command that uses the payload.
_ENABLE_PARAMETERS: dict[int, str] = {
    _CMD.DO_GRIPPER: "GRIP_ENABLE",
    _CMD.DO_SPRAYER: "SPRAY_ENABLE",
    _CMD.DO_WINCH: "WINCH_TYPE",
}


class ArdupilotArming(ArmingCommands):
    """Arming answers FAILED with the problems; disarming in the air answers FAILED without a text."""

    def arm_or_disarm(self, request: CommandRequest) -> Outcome:
        """Answer COMPONENT_ARM_DISARM."""
        if request.command.param1 == 1 and request.command.param2 == _FORCE_ARMING:
            return self.arm(force=True)
        return super().arm_or_disarm(request)

    def disarm(self, *, force: bool) -> common.MavResult:
        """Disarm; only a copter or plane in the air refuses."""
        if self.autopilot.armed and not force and self.disarm_refusal():
            return _RESULT.FAILED
        return super().disarm(force=True)

    def run_checks(self, request: CommandRequest) -> common.MavResult:
        """Answer RUN_PREARM_CHECKS."""
        if self.autopilot.armed:
            return _RESULT.TEMPORARILY_REJECTED
        for problem in prearm_problems(self.autopilot):
            self.vehicle.send_statustext(f"PreArm: {problem}", common.MavSeverity.CRITICAL)
        return _RESULT.ACCEPTED


class ArdupilotHome(HomeCommands):
    """Home, and the origin of the filter."""

    def handlers(self) -> Handlers:
        handlers = dict(super().handlers())
        if self.vehicle.vehicle_type.on_surface:
            for command in (_CMD.DO_SET_ROI, _CMD.DO_SET_ROI_LOCATION, _CMD.DO_SET_ROI_NONE):
                del handlers[command]
        return handlers

    def set_home(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_SET_HOME: zeros mean here as well; an unknown frame is DENIED."""
        command, autopilot = request.command, self.autopilot
        if command.param1 == 1 or not has_place(command):
            if not autopilot.has_position:
                return _RESULT.FAILED
            autopilot.set_home_here()
        elif command.param1 != 0:
            return _RESULT.FAILED
        else:
            point = place_of(autopilot, command, usual=common.MavFrame.GLOBAL, bad_frame=_RESULT.DENIED)
            autopilot.set_home(*autopilot.body.frame.to_global(*point))
        autopilot.home_locked = True
        return _RESULT.ACCEPTED

    def send_home(self, request: CommandRequest) -> common.MavResult:
        """Answer GET_HOME_POSITION with home and origin."""
        result = super().send_home(request)
        if result == _RESULT.ACCEPTED:
            self.vehicle.services.send(origin_of(self.vehicle), request.source)
        return result


class ArdupilotMission(MissionCommands):
    """Mission commands; a copter can pause."""

    def handlers(self) -> Handlers:
        handlers: dict[int, Handler] = {_CMD.MISSION_START: self.start, _CMD.DO_JUMP_TAG: self.jump_to_tag}
        if self.vehicle.vehicle_type.flies:
            handlers[_CMD.DO_LAND_START] = self.start_landing
        if self.vehicle.vehicle_type is VehicleType.COPTER:
            handlers[_CMD.DO_PAUSE_CONTINUE] = self.pause_or_continue
        return handlers

    def start(self, request: CommandRequest) -> common.MavResult:
        """Answer MISSION_START: param1 and param2 must be 0; a running mission continues."""
        if request.command.param1 != 0 or request.command.param2 != 0:
            return _RESULT.DENIED
        if self.vehicle.vehicle_type is VehicleType.SUB and not self.autopilot.armed:
            return _RESULT.FAILED
        if self.autopilot.mission.flying:
            return _RESULT.ACCEPTED
        return self.enter(self.autopilot.profile.mission)

    def jump_to_tag(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_JUMP_TAG: continue the mission at the item with a tag."""
        mission = self.autopilot.mission
        for seq, item in enumerate(mission.items):
            if item.command == _CMD.JUMP_TAG and item.param1 == request.command.param1:
                return accept(mission.go_to_item(seq))
        return _RESULT.FAILED

    def start_landing(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_LAND_START: fly the mission's landing sequence."""
        if not land_by_mission(self.autopilot, "commanded"):
            raise CommandRefusedError(_RESULT.FAILED, "Unable to start landing sequence")
        return _RESULT.ACCEPTED

    def pause(self) -> common.MavResult:
        """Pause in AUTO or GUIDED."""
        autopilot = self.autopilot
        if autopilot.mission.flying and autopilot.mission.pause():
            return _RESULT.ACCEPTED
        if autopilot.mode.number == autopilot.profile.guided and autopilot.armed and not autopilot.landed:
            autopilot.guided.go_to(autopilot.maneuvers.stopping_point)
            return _RESULT.ACCEPTED
        self.vehicle.send_statustext("Failed to pause", _INFO)
        return _RESULT.FAILED

    def resume(self) -> common.MavResult:
        """Resume in AUTO."""
        if self.autopilot.mission.flying and self.autopilot.mission.resume():
            return _RESULT.ACCEPTED
        self.vehicle.send_statustext("Failed to resume", _INFO)
        return _RESULT.FAILED


class ArdupilotEquipment(CommandGroup):
    """Payloads that a parameter enables; commands for a disabled one answer FAILED."""

    def handlers(self) -> Handlers:
        outputs = dict(EquipmentCommands(self.vehicle).handlers())
        vehicle_type = self.vehicle.vehicle_type
        if vehicle_type is not VehicleType.COPTER:
            del outputs[_CMD.DO_WINCH]
        if vehicle_type not in (VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL):
            del outputs[_CMD.DO_PARACHUTE]
        if vehicle_type not in (VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT):
            del outputs[_CMD.DO_SPRAYER]
        guarded = {command: self._guarded(command, handler) for command, handler in outputs.items()}
        cameras = CameraCommands(self.vehicle).handlers()
        gimbals = GimbalCommands(self.vehicle).handlers()
        return {
            **guarded,
            **{command: self._if_enabled("CAM1_TYPE", handler) for command, handler in cameras.items()},
            **{command: self._if_enabled("MNT1_TYPE", handler) for command, handler in gimbals.items()},
        }

    def _guarded(self, command: int, handler: Handler) -> Handler:
        """Return the handler, checked for its enabling parameter."""
        name = _ENABLE_PARAMETERS.get(command)
        return handler if name is None else self._if_enabled(name, handler)

    def _if_enabled(self, name: str, handler: Handler) -> Handler:
        """Return a handler that fails while a parameter is 0."""

        def execute(request: CommandRequest) -> Outcome:
            if not self.vehicle.parameters.get(name, 0):
                return _RESULT.FAILED
            return handler(request)

        return execute


class ArdupilotSystem(CommandGroup):
    """Fence, EKF sources, battery, auxiliary functions, banner."""

    def handlers(self) -> Handlers:
        return {
            _CMD.DO_FENCE_ENABLE: self.enable_fence,
            _CMD.DO_AUX_FUNCTION: self.use_switch,
            _CMD.DO_SEND_BANNER: self.send_banner,
            _CMD.BATTERY_RESET: self.reset_battery,
            _CMD.SET_EKF_SOURCE_SET: self.select_sources,
            development.MavCmd.EXTERNAL_WIND_ESTIMATE: self.set_wind,
        }

    def enable_fence(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_FENCE_ENABLE: 0 off, 1 on, 2 disables the floor only."""
        requested, parameters = whole(request.command.param1), self.vehicle.parameters
        if requested not in (0, 1, 2):
            return _RESULT.FAILED
        if requested == 2:
            parameters.set("FENCE_TYPE", int(parameters["FENCE_TYPE"]) & ~8)
        else:
            parameters.set("FENCE_ENABLE", requested)
        return _RESULT.ACCEPTED

    def use_switch(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_AUX_FUNCTION: like a switch of the transmitter with that function."""
        function, position = whole(request.command.param1), whole(request.command.param2)
        if function is None or position not in (0, 1, 2):
            return _RESULT.DENIED
        return accept(use_auxiliary_function(self.autopilot, function, position))

    def send_banner(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_SEND_BANNER."""
        for line in banner_of(self.vehicle):
            self.vehicle.send_statustext(line, _INFO)
        return _RESULT.ACCEPTED

    def reset_battery(self, request: CommandRequest) -> common.MavResult:
        """Answer BATTERY_RESET: set battery 1 to param2 percent."""
        batteries, percent = whole(request.command.param1), request.command.param2
        if batteries is None or not batteries & 1 or not 0.0 <= percent <= 100.0:
            raise CommandRefusedError(_RESULT.FAILED)
        self.autopilot.body.recharge(remaining=percent / 100.0)
        return _RESULT.ACCEPTED

    def set_wind(self, request: CommandRequest) -> common.MavResult:
        """Answer EXTERNAL_WIND_ESTIMATE, which counts for DCM only: WIND shows the estimate of the EKF."""
        speed, direction = request.command.param1, request.command.param3
        return _RESULT.DENIED if speed < 0 or not 0 <= direction <= 360 else _RESULT.ACCEPTED

    def select_sources(self, request: CommandRequest) -> common.MavResult:
        """Answer SET_EKF_SOURCE_SET: 1 to 3."""
        requested = whole(request.command.param1)
        if requested is None or not 1 <= requested <= _MAX_SOURCES:
            return _RESULT.DENIED
        self.vehicle.send_statustext(f"Using EKF Source Set {requested}", _INFO)
        return _RESULT.ACCEPTED


def origin_of(vehicle: SimulatedVehicle) -> common.GpsGlobalOrigin:
    """Return GPS_GLOBAL_ORIGIN: the origin of the local frame."""
    latitude, longitude, altitude = vehicle.body.frame.to_global(0.0, 0.0, 0.0)
    return common.GpsGlobalOrigin(
        latitude=round(latitude * 1e7),
        longitude=round(longitude * 1e7),
        altitude=round(altitude * 1e3),
        time_usec=int(vehicle.uptime * 1e6),
    )


_MOVEMENTS: dict[VehicleType, type[ArdupilotMovement]] = {
    VehicleType.COPTER: CopterMovement,
    VehicleType.PLANE: PlaneMovement,
    VehicleType.VTOL: QuadplaneMovement,
    VehicleType.ROVER: RoverMovement,
    VehicleType.BOAT: RoverMovement,
    VehicleType.SUB: SubMovement,
}


def command_groups(vehicle: SimulatedVehicle) -> Iterator[CommandGroup]:
    """Yield all command groups of a vehicle's firmware."""
    yield ArdupilotArming(vehicle)
    yield ArdupilotHome(vehicle)
    yield ArdupilotMission(vehicle)
    yield ArdupilotEquipment(vehicle)
    yield ArdupilotMaintenance(vehicle)
    yield ArdupilotSystem(vehicle)
    yield _MOVEMENTS[vehicle.vehicle_type](vehicle)


def register_commands(vehicle: SimulatedVehicle) -> None:
    """Register the commands of a vehicle's firmware."""
    for command in _UNSUPPORTED:
        vehicle.commands.support(command, lambda _: _RESULT.UNSUPPORTED)
    for group in command_groups(vehicle):
        register_handlers(vehicle, group.handlers())
