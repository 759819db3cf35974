"""PX4 on the ground: calibration, reboot, storage, actuators, gripper.

A calibration is ACCEPTED when it begins; how far it is comes as texts that ground stations read.
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.commands import Handlers, MaintenanceCommands, Outcome, number, waiting, whole

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.commands.tasks import Script
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.px4.state import Px4State

_CMD, _RESULT = common.MavCmd, common.MavResult
_FUNCTION = common.ActuatorOutputFunction
_GRAB, _RELEASE = common.GripperActions.GRAB, common.GripperActions.RELEASE
_LOAD, _SAVE, _RESET_CONFIGURATION, _RESET_SENSORS, _RESET_ALL = range(5)
_MOST_MOTORS, _MOST_SERVOS = 12, 8
_LONGEST_TEST: Final = 3.0
#: Servos that DO_SET_ACTUATOR moves, its first being this one.
_FIRST_ACTUATOR, _ACTUATORS = 9, 6
_MIDDLE, _HALF = 1500, 500
_GRIPPER_TIME: Final = 1.0
#: Seconds for each tenth of a calibration.
_STEP = 0.2


class Px4MaintenanceCommands(MaintenanceCommands):
    """With PX4's answers and words."""

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
        """PREFLIGHT_REBOOT_SHUTDOWN: only disarmed; shutting down is not for this hardware."""
        if self.autopilot.armed or whole(request.command.param1) not in self.reboots:
            return _RESULT.DENIED
        self.autopilot.tasks.on_next_tick(self.vehicle.reboot)
        return _RESULT.ACCEPTED

    def store(self, request: CommandRequest) -> common.MavResult:
        """PREFLIGHT_STORAGE: parameters are saved as they are set; they can be made the defaults again."""
        wanted = whole(request.command.param1)
        if self.autopilot.armed:
            return _RESULT.TEMPORARILY_REJECTED
        if wanted in (_RESET_CONFIGURATION, _RESET_SENSORS, _RESET_ALL):
            self.vehicle.parameters.reset()
            return _RESULT.ACCEPTED
        return _RESULT.ACCEPTED if wanted in (_LOAD, _SAVE) else _RESULT.UNSUPPORTED

    # Calibration

    def calibrate(self, request: CommandRequest) -> Outcome:
        """PREFLIGHT_CALIBRATION: one sensor at a time."""
        if self.autopilot.armed or self._state.calibrating:
            return _RESULT.TEMPORARILY_REJECTED
        wanted = self.requested_calibrations(request)
        if not wanted:
            return _RESULT.UNSUPPORTED
        self._state.calibrating = wanted[0]
        self.autopilot.tasks.run(self.calibrating(wanted))
        return _RESULT.ACCEPTED

    def requested_calibrations(self, request: CommandRequest) -> list[str]:
        """The first that the command names; what needs the vehicle turned by hand fails in the end."""
        command = request.command
        first = {
            "gyro": command.param1 == 1,
            "mag": command.param2 == 1,
            "baro": command.param3 == 1,
            "level": command.param5 == 2,
            "accel": command.param5 in (1, 4),
            "airspeed": command.param6 in (1, 2),
        }
        return [name for name, wanted in first.items() if wanted][:1]

    def calibrating(self, wanted: list[str]) -> Script:
        """Calibrate, and say how far it is; a barometer's has no progress."""
        for name in wanted:
            self.vehicle.send_statustext(f"[cal] calibration started: 2 {name}")
            for percent in range(0, 101, 10):
                if name != "baro":
                    self.vehicle.send_statustext(f"[cal] progress <{percent}>")
                yield from waiting(self.vehicle, _STEP)
            self._heal(name)
            self.vehicle.send_statustext(f"[cal] calibration done: {name}")
        self._state.calibrating = ""
        return _RESULT.ACCEPTED

    def _heal(self, name: str) -> None:
        """What was wrong with a sensor is calibrated away."""
        if name == "mag":
            self.vehicle.faults.inject("compass 0")
        elif name == "baro":
            self.vehicle.faults.inject("baro 0")

    # Actuators

    def test_actuator(self, request: CommandRequest) -> common.MavResult:
        """ACTUATOR_TEST: one motor or servo for a few seconds; no time ends the test."""
        command = request.command
        function, value = whole(number(command.param5)), number(command.param1)
        if self.autopilot.armed or function is None:
            return _RESULT.DENIED
        seconds = min(max(number(command.param2), 0.0), _LONGEST_TEST)
        if _FUNCTION.MOTOR1 <= function < _FUNCTION.MOTOR1 + _MOST_MOTORS:
            motor = function - _FUNCTION.MOTOR1 + 1
            self.autopilot.payload.test_motor(motor, min(max(value, 0.0), 1.0) * 100, seconds)
            return _RESULT.ACCEPTED
        if _FUNCTION.SERVO1 <= function < _FUNCTION.SERVO1 + _MOST_SERVOS:
            self.autopilot.payload.set_servo(function - _FUNCTION.SERVO1 + 1, _pulse(value))
            return _RESULT.ACCEPTED
        return _RESULT.UNSUPPORTED

    def set_actuators(self, request: CommandRequest) -> common.MavResult:
        """DO_SET_ACTUATOR: the first set of six, each -1 to 1, NaN leaving one as it is."""
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
        """DO_GRIPPER: it takes its time."""
        action = whole(request.command.param2)
        if action not in (_GRAB, _RELEASE):
            return _RESULT.FAILED
        self.autopilot.tasks.begin(request, self._gripping(closed=action == _GRAB))
        return None

    def _gripping(self, *, closed: bool) -> Script:
        yield from waiting(self.vehicle, _GRIPPER_TIME)
        self.autopilot.payload.grip(closed=closed)
        return _RESULT.ACCEPTED


def _pulse(value: float) -> int:
    return round(_MIDDLE + _HALF * min(max(value, -1.0), 1.0))
