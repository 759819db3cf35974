"""PX4's ground commands: calibration, reboot, storage, actuators, gripper.

A calibration is ACCEPTED when it starts; its progress is reported in status texts that ground stations parse.
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.commands import Handlers, MaintenanceCommands, Outcome, number, waiting, whole

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.autopilot.tasks import Script
    from mavstack.sim.px4.state import Px4State

_CMD, _RESULT = common.MavCmd, common.MavResult
_FUNCTION = common.ActuatorOutputFunction
_GRAB, _RELEASE = common.GripperActions.GRAB, common.GripperActions.RELEASE
_LOAD, _SAVE, _RESET_CONFIGURATION, _RESET_SENSORS, _RESET_ALL = range(5)
_MAX_MOTORS, _MAX_SERVOS = 12, 8
_MAX_TEST_TIME: Final = 3.0
#: First servo of DO_SET_ACTUATOR, and number of servos.
_FIRST_ACTUATOR, _ACTUATORS = 9, 6
_CENTRE_PULSE, _PULSE_RANGE = 1500, 500
_GRIPPER_TIME: Final = 1.0
#: Seconds per 10 % of a calibration.
_CALIBRATION_STEP = 0.2


class Px4MaintenanceCommands(MaintenanceCommands):
    """Ground commands with PX4's answers and status texts."""

    def __init__(self, vehicle: Vehicle, state: Px4State) -> None:
        super().__init__(vehicle)
        self._state = state

    def handlers(self) -> Handlers:
        return {
            _CMD.PREFLIGHT_REBOOT_SHUTDOWN: self.reboot,
            _CMD.PREFLIGHT_CALIBRATION: self.calibrate,
            _CMD.PREFLIGHT_STORAGE: self.store,
            _CMD.ACTUATOR_TEST: self.test_actuator,
            _CMD.DO_SET_ACTUATOR: self.set_actuators,
            _CMD.DO_GRIPPER: self.grip,
        }

    def reboot(self, request: CommandRequest) -> common.MavResult:
        """Answer PREFLIGHT_REBOOT_SHUTDOWN: only while disarmed; shutdown is not supported."""
        if self.autopilot.armed or whole(request.command.param1) not in self.reboots:
            return _RESULT.DENIED
        self.autopilot.tasks.on_next_tick(self.vehicle.reboot)
        return _RESULT.ACCEPTED

    def store(self, request: CommandRequest) -> common.MavResult:
        """Answer PREFLIGHT_STORAGE: parameters are always saved; they can be reset."""
        requested = whole(request.command.param1)
        if self.autopilot.armed:
            return _RESULT.TEMPORARILY_REJECTED
        if requested in (_RESET_CONFIGURATION, _RESET_SENSORS, _RESET_ALL):
            self.vehicle.parameters.reset()
            return _RESULT.ACCEPTED
        return _RESULT.ACCEPTED if requested in (_LOAD, _SAVE) else _RESULT.UNSUPPORTED

    # Calibration

    def calibrate(self, request: CommandRequest) -> Outcome:
        """Answer PREFLIGHT_CALIBRATION: one sensor at a time."""
        if self.autopilot.armed or self._state.calibrating:
            return _RESULT.TEMPORARILY_REJECTED
        requested = self.requested_calibrations(request)
        if not requested:
            return _RESULT.UNSUPPORTED
        self._state.calibrating = requested[0]
        self.autopilot.tasks.run(self.calibrating(requested))
        return _RESULT.ACCEPTED

    def requested_calibrations(self, request: CommandRequest) -> list[str]:
        """Return the first calibration that the command requests."""
        command = request.command
        first = {
            "gyro": command.param1 == 1,
            "mag": command.param2 == 1,
            "baro": command.param3 == 1,
            "level": command.param5 == 2,
            "accel": command.param5 in (1, 4),
            "airspeed": command.param6 in (1, 2),
        }
        return [name for name, requested in first.items() if requested][:1]

    def calibrating(self, requested: list[str]) -> Script:
        """Calibrate and report progress; a barometer has none."""
        for name in requested:
            self.vehicle.send_statustext(f"[cal] calibration started: 2 {name}")
            for percent in range(0, 101, 10):
                if name != "baro":
                    self.vehicle.send_statustext(f"[cal] progress <{percent}>")
                yield from waiting(self.vehicle, _CALIBRATION_STEP)
            self._clear_fault(name)
            self.vehicle.send_statustext(f"[cal] calibration done: {name}")
        self._state.calibrating = ""
        return _RESULT.ACCEPTED

    def _clear_fault(self, name: str) -> None:
        """Clear the fault of a calibrated sensor."""
        if name == "mag":
            self.vehicle.faults.inject("compass 0")
        elif name == "baro":
            self.vehicle.faults.inject("baro 0")

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
