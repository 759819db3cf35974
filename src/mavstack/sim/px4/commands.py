"""PX4's commands and their answers: arming, modes, home, missions.

Flight commands are in `movement.py`, ground commands in `maintenance.py`, failures in `failures.py`. The
server answers unregistered commands with UNSUPPORTED. PX4 refuses most commands that are impossible now with
TEMPORARILY_REJECTED, and explains it to ground stations with the component id of mission planners.
"""

from __future__ import annotations

from math import isfinite, radians
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.commands import (
    ArmingCommands,
    CommandGroup,
    Handlers,
    HomeCommands,
    MissionCommands,
    Outcome,
    number,
    register_handlers,
    whole,
)
from mavstack.sim.px4.arm_authorization import ArmAuthorization
from mavstack.sim.px4.arming import arm, disarm, preflight_problems
from mavstack.sim.px4.calibration import Px4CalibrationCommands
from mavstack.sim.px4.failures import FailureCommands
from mavstack.sim.px4.maintenance import Px4MaintenanceCommands
from mavstack.sim.px4.mode_selection import AUTO, choose_mode, custom_mode_of, mode_of_flags, unavailable_text
from mavstack.sim.px4.modes import MISSION, NOT_SELECTABLE, STANDARD_MODES, STANDARD_MODES_OF_WINGS
from mavstack.sim.px4.movement import Px4Movement
from mavstack.sim.px4.state import BY_COMMAND, BY_MISSION

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.command import CommandRequest
    from mavstack.sim.px4.state import Px4State
    from mavstack.sim.vehicle import SimulatedVehicle

_CMD, _RESULT = common.MavCmd, common.MavResult
_CRITICAL = common.MavSeverity.CRITICAL
_FLAGS: Final = common.MavModeFlag
_FORCE: Final = 21196
#: Only requests from this component id get a status text with the reason of a refused mode.
_PLANNER: Final = common.MavComponent.MISSIONPLANNER


class Px4Arming(ArmingCommands):
    """Arming and disarming, with PX4's status texts."""

    refusal = _RESULT.TEMPORARILY_REJECTED

    def __init__(self, vehicle: SimulatedVehicle, state: Px4State) -> None:
        super().__init__(vehicle)
        self._state = state
        self._authorization = ArmAuthorization(vehicle)

    def arm_or_disarm(self, request: CommandRequest) -> Outcome:
        """Answer COMPONENT_ARM_DISARM."""
        requested, force = request.command.param1, number(request.command.param2)
        if not isfinite(requested) or round(requested) not in (0, 1):
            self.vehicle.send_statustext(f"Unsupported ARM_DISARM param: {requested:.3f}", _CRITICAL)
            return _RESULT.UNSUPPORTED
        forced = round(force) == _FORCE
        if not round(requested):
            return self.disarm(force=forced)
        if self._authorization.is_needed and not self.autopilot.armed and self._passes_checks():
            return self._authorization.ask(request, lambda: self.arm(force=False))
        return self.arm(force=False)

    def _passes_checks(self) -> bool:
        return next(preflight_problems(self.autopilot), None) is None

    def arm(self, *, force: bool) -> common.MavResult:
        """Arm; external commands cannot skip the checks."""
        armed = arm(self.vehicle, self._state, BY_COMMAND)
        return _RESULT.ACCEPTED if armed else self.refusal

    def disarm(self, *, force: bool) -> common.MavResult:
        """Disarm; in the air only if forced."""
        disarmed = disarm(self.vehicle, self._state, BY_COMMAND, force=force)
        return _RESULT.ACCEPTED if disarmed else self.refusal

    def run_checks(self, request: CommandRequest) -> common.MavResult:
        """Answer RUN_PREARM_CHECKS."""
        for problem in () if self.autopilot.armed else preflight_problems(self.autopilot):
            self.vehicle.send_statustext(problem, _CRITICAL)
        return _RESULT.ACCEPTED

    def terminate(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_FLIGHTTERMINATION, accepted only while armed."""
        if not (request.command.param1 > 0.5 and self.autopilot.armed):
            return _RESULT.DENIED
        self.autopilot.terminate()
        return _RESULT.ACCEPTED


class ModeCommands(CommandGroup):
    """DO_SET_MODE and DO_SET_STANDARD_MODE; any mode may be selected while disarmed."""

    def handlers(self) -> Handlers:
        return {_CMD.DO_SET_MODE: self.set_mode, _CMD.DO_SET_STANDARD_MODE: self.set_standard_mode}

    def set_mode(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_SET_MODE: by PX4's numbers, or by flags alone."""
        command = request.command
        flags, main, sub = (
            whole(number(value)) or 0 for value in (command.param1, command.param2, command.param3)
        )
        if not flags & _FLAGS.CUSTOM_MODE_ENABLED:
            requested = mode_of_flags(flags)
            return self._unsupported("base") if requested is None else self._choose(requested, request)
        mode = self.autopilot.find_mode(custom_mode_of(main, sub))
        if mode is None or mode.number in NOT_SELECTABLE:
            return self._unsupported("auto" if main == AUTO else "main")
        return self._choose(mode.number, request)

    def set_standard_mode(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_SET_STANDARD_MODE."""
        names = STANDARD_MODES_OF_WINGS if self.autopilot.maneuvers.circles else STANDARD_MODES
        requested = names.get(whole(request.command.param1) or 0)
        if requested is None or self.autopilot.find_mode(requested) is None:
            return _RESULT.FAILED
        return self._choose(requested, request)

    def _choose(self, requested: int, request: CommandRequest) -> common.MavResult:
        """Enter a mode; explain a refusal to mission planners only."""
        refused = choose_mode(self.vehicle, requested)
        if refused is None:
            return _RESULT.ACCEPTED
        if request.source.component == _PLANNER:
            self.vehicle.send_statustext(refused, _CRITICAL)
        return _RESULT.TEMPORARILY_REJECTED

    def _unsupported(self, kind: str) -> common.MavResult:
        """Refuse an unsupported mode."""
        self.vehicle.send_statustext(f"Unsupported {kind} mode", _CRITICAL)
        return _RESULT.TEMPORARILY_REJECTED


class Px4Home(HomeCommands):
    """Home and region of interest."""

    def handlers(self) -> Handlers:
        handlers = dict(super().handlers())
        del handlers[_CMD.GET_HOME_POSITION]
        return handlers | {_CMD.NAV_ROI: self.set_region}

    def set_home(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_SET_HOME: here, or at a position above mean sea level in any frame.

        COM_HOME_EN = 0 denies it.
        """
        command, autopilot = request.command, self.autopilot
        if not int(self.vehicle.parameters["COM_HOME_EN"]):
            return _RESULT.DENIED
        if number(command.param1) > 0.5:
            if not autopilot.has_position:
                return _RESULT.TEMPORARILY_REJECTED
            autopilot.set_home_here()
            return _RESULT.ACCEPTED
        place = (command.param5, command.param6, command.param7)
        if not all(map(isfinite, place)) or abs(place[0]) > 90.0 or abs(place[1]) > 180.0:
            return _RESULT.DENIED
        autopilot.set_home(*place, yaw=radians(number(command.param4)))
        autopilot.home_locked = True
        return _RESULT.ACCEPTED


class Px4Mission(MissionCommands):
    """MISSION_START, which arms, and DO_LAND_START."""

    def __init__(self, vehicle: SimulatedVehicle, state: Px4State) -> None:
        super().__init__(vehicle)
        self._state = state

    def handlers(self) -> Handlers:
        return {_CMD.MISSION_START: self.start, _CMD.DO_LAND_START: self.start_landing}

    def start(self, request: CommandRequest) -> common.MavResult:
        """Answer MISSION_START: from item param1, or from the current one."""
        mission = self.autopilot.mission
        if not mission.valid():
            self.vehicle.send_statustext("Mission start denied! No valid mission", _CRITICAL)
            return _RESULT.DENIED
        first = request.command.param1
        if not -1 <= first < len(mission.items):
            return _RESULT.DENIED
        if first >= 0:
            mission.go_to_item(int(first))
        return self._fly()

    def start_landing(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_LAND_START: continue the mission at its landing."""
        mission = self.autopilot.mission
        start = mission.landing_start()
        if start is None:
            return _RESULT.CANCELLED
        mission.go_to_item(start)
        return self._fly()

    def _fly(self) -> common.MavResult:
        """Enter Mission and arm."""
        refused = choose_mode(self.vehicle, MISSION)
        if refused is not None or not arm(self.vehicle, self._state, BY_MISSION):
            self.vehicle.send_statustext(refused or unavailable_text("Mission"), _CRITICAL)
            return _RESULT.TEMPORARILY_REJECTED
        return _RESULT.ACCEPTED


def command_groups(vehicle: SimulatedVehicle, state: Px4State) -> Iterator[CommandGroup]:
    """Yield all command groups of a vehicle."""
    yield Px4Arming(vehicle, state)
    yield ModeCommands(vehicle)
    yield Px4Home(vehicle)
    yield Px4Mission(vehicle, state)
    yield Px4Movement(vehicle, state)
    yield Px4MaintenanceCommands(vehicle)
    yield Px4CalibrationCommands(vehicle, state)
    yield FailureCommands(vehicle)


def register_commands(vehicle: SimulatedVehicle, state: Px4State) -> None:
    """Register all commands of a vehicle."""
    for group in command_groups(vehicle, state):
        register_handlers(vehicle, group.handlers())
