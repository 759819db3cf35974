"""PX4's ground commands: reboot, storage, actuators, gripper, wind."""

from __future__ import annotations

from math import cos, isfinite, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common, development
from mavstack.sim.autopilot.commands import Handlers, MaintenanceCommands, Outcome, number, waiting, whole
from mavstack.sim.motion.readings import Wind

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.tasks import Script

_CMD, _RESULT = common.MavCmd, common.MavResult
_FUNCTION = common.ActuatorOutputFunction
_GRAB, _RELEASE = common.GripperActions.GRAB, common.GripperActions.RELEASE
_LOAD, _SAVE, _RESET_CONFIGURATION, _RESET_SENSORS, _RESET_ALL = range(5)
_MAX_MOTORS, _MAX_SERVOS = 12, 8
_MAX_TEST_TIME: Final = 3.0
#: Number of the first servo of DO_SET_ACTUATOR, and number of servos.
_FIRST_ACTUATOR, _ACTUATORS = 9, 6
_CENTRE_PULSE, _PULSE_RANGE = 1500, 500
_GRIPPER_TIME: Final = 1.0


class Px4MaintenanceCommands(MaintenanceCommands):
    """Ground commands with PX4's answers and status texts."""

    def handlers(self) -> Handlers:
        return {
            _CMD.PREFLIGHT_REBOOT_SHUTDOWN: self.reboot,
            _CMD.PREFLIGHT_STORAGE: self.store,
            _CMD.ACTUATOR_TEST: self.test_actuator,
            _CMD.DO_SET_ACTUATOR: self.set_actuators,
            _CMD.DO_GRIPPER: self.grip,
            development.MavCmd.EXTERNAL_WIND_ESTIMATE: self.set_wind,
        }

    def set_wind(self, request: CommandRequest) -> common.MavResult:
        """Answer EXTERNAL_WIND_ESTIMATE, which counts on the ground only."""
        speed, bearing = max(number(request.command.param1), 0.0), radians(number(request.command.param3))
        if self.autopilot.body.on_ground:
            self.autopilot.body.wind_report = Wind(-speed * cos(bearing), -speed * sin(bearing), 0.0)
        return _RESULT.ACCEPTED

    def reboot(self, request: CommandRequest) -> common.MavResult:
        """Answer PREFLIGHT_REBOOT_SHUTDOWN: only while disarmed; shutdown is not supported."""
        wanted = whole(request.command.param1)
        if self.autopilot.armed or wanted not in self.reboots:
            return _RESULT.DENIED
        self.restart(wanted)
        return _RESULT.ACCEPTED

    def store(self, request: CommandRequest) -> common.MavResult:
        """Answer PREFLIGHT_STORAGE: save the parameters that wait for their delay, or reset."""
        requested = whole(request.command.param1)
        if self.autopilot.armed:
            return _RESULT.TEMPORARILY_REJECTED
        if requested in (_RESET_CONFIGURATION, _RESET_SENSORS, _RESET_ALL):
            self.vehicle.parameters.reset()
            return _RESULT.ACCEPTED
        if requested == _SAVE:
            self.vehicle.parameters.save()
        return _RESULT.ACCEPTED if requested in (_LOAD, _SAVE) else _RESULT.UNSUPPORTED

    # Actuators

    def test_actuator(self, request: CommandRequest) -> common.MavResult:
        """Answer ACTUATOR_TEST: one motor or servo for some seconds; zero seconds end the test."""
        command = request.command
        function, value = whole(number(command.param5)), number(command.param1)
        if self.autopilot.armed or function is None:
            return _RESULT.DENIED
        seconds = min(max(number(command.param2), 0.0), _MAX_TEST_TIME)
        if _FUNCTION.MOTOR1 <= function < _FUNCTION.MOTOR1 + _MAX_MOTORS:
            motor = function - _FUNCTION.MOTOR1 + 1
            self.autopilot.payload.test_motor(motor, min(max(value, 0.0), 1.0) * 100, seconds)
            return _RESULT.ACCEPTED
        if _FUNCTION.SERVO1 <= function < _FUNCTION.SERVO1 + _MAX_SERVOS:
            self.autopilot.payload.set_servo(function - _FUNCTION.SERVO1 + 1, _pulse(value))
            return _RESULT.ACCEPTED
        return _RESULT.UNSUPPORTED

    def set_actuators(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_SET_ACTUATOR: the first set of six, each -1 to 1; NaN changes nothing."""
        command = request.command
        values = (
            command.param1, command.param2, command.param3, command.param4, command.param5, command.param6,
        )  # fmt: skip
        moved = [(servo, value) for servo, value in enumerate(values, _FIRST_ACTUATOR) if isfinite(value)]
        if number(command.param7) != 0 or not moved:
            return _RESULT.DENIED
        for servo, value in moved:
            self.autopilot.payload.set_servo(servo, _pulse(value))
        return _RESULT.ACCEPTED

    def grip(self, request: CommandRequest) -> Outcome:
        """Answer DO_GRIPPER, which takes some time."""
        action = whole(request.command.param2)
        if action not in (_GRAB, _RELEASE):
            return _RESULT.FAILED
        self.autopilot.tasks.begin(request, self._run_gripper(closed=action == _GRAB))
        return None

    def _run_gripper(self, *, closed: bool) -> Script:
        """Move the gripper."""
        yield from waiting(self.vehicle, _GRIPPER_TIME)
        self.autopilot.payload.grip(closed=closed)
        return _RESULT.ACCEPTED


def _pulse(value: float) -> int:
    """Return the pulse of a value of -1 to 1."""
    return round(_CENTRE_PULSE + _PULSE_RANGE * min(max(value, -1.0), 1.0))
