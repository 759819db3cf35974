"""ArduPilot on the ground: calibration, parameters, reboot, motor tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.sensor_calibration import calibrations_of
from mavstack.sim.autopilot.commands import (
    CommandRefusedError,
    Handlers,
    MaintenanceCommands,
    Outcome,
    accept,
    whole,
)
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest

_CMD, _RESULT = ardupilotmega.MavCmd, common.MavResult
_RESET = 2
_SIX_POSITIONS, _LEVEL, _SIMPLE_ACCEL = 1, 2, 4
_DONE = {
    "gyro": "Gyro calibration successful",
    "baro": "Barometer calibration complete",
    "accel": "Accelerometer calibration successful",
    "level": "Trim OK: roll=0.00 pitch=0.00 yaw=0.00",
}
_BEGUN = {
    "baro": "Updating barometer calibration",
    "gyro": "Calibrating gyros",
    "accel": "Calibrating accelerometers",
}


class ArdupilotMaintenance(MaintenanceCommands):
    """With ArduPilot's answers and words."""

    def handlers(self) -> Handlers:
        handlers = {
            **super().handlers(),
            _CMD.DO_START_MAG_CAL: self.start_compass,
            _CMD.DO_ACCEPT_MAG_CAL: self.accept_compass,
            _CMD.DO_CANCEL_MAG_CAL: self.cancel_compass,
            _CMD.ACCELCAL_VEHICLE_POS: self.placed,
        }
        if self.vehicle.type is VehicleType.PLANE:
            del handlers[_CMD.DO_MOTOR_TEST]
        return handlers

    def refuse_calibration(self) -> common.MavResult:
        """Armed."""
        raise CommandRefusedError(_RESULT.FAILED, "Disarm to allow calibration")

    def calibrate(self, request: CommandRequest) -> Outcome:
        """PREFLIGHT_CALIBRATION: with param 5 = 1 the accelerometers, by the pilot's hands."""
        if whole(request.command.param5) == _SIX_POSITIONS and not self.autopilot.armed:
            calibrations_of(self.autopilot).begin_accelerometers()
            return _RESULT.ACCEPTED
        return super().calibrate(request)

    def placed(self, request: CommandRequest) -> common.MavResult:
        """ACCELCAL_VEHICLE_POS: it lies as it was asked to."""
        position = whole(request.command.param1)
        return accept(position is not None and calibrations_of(self.autopilot).placed(position))

    def start_compass(self, request: CommandRequest) -> common.MavResult:
        """DO_START_MAG_CAL: param 3 = 1 accepts the result by itself."""
        if self.autopilot.armed:
            raise CommandRefusedError(_RESULT.FAILED, "Disarm to allow calibration")
        calibrations_of(self.autopilot).begin_compass(accept=request.command.param3 == 1)
        return _RESULT.ACCEPTED

    def accept_compass(self, request: CommandRequest) -> common.MavResult:
        """DO_ACCEPT_MAG_CAL."""
        return accept(calibrations_of(self.autopilot).accept_compass())

    def cancel_compass(self, request: CommandRequest) -> common.MavResult:
        """DO_CANCEL_MAG_CAL."""
        calibrations_of(self.autopilot).cancel_compass()
        return _RESULT.ACCEPTED

    def wanted_calibrations(self, request: CommandRequest) -> list[str]:
        """Gyros, barometer, and the accelerometers level or in one position; the rest it cannot here."""
        command = request.command
        wanted = []
        if command.param1 == 1:
            wanted.append("gyro")
        if command.param3 == 1:
            wanted.append("baro")
        if whole(command.param5) == _LEVEL:
            wanted.append("level")
        elif whole(command.param5) == _SIMPLE_ACCEL:
            wanted.append("accel")
        return wanted

    def say_begun(self, name: str) -> None:
        """As the sensor's driver says it."""
        if name in _BEGUN:
            self.vehicle.send_statustext(_BEGUN[name])

    def say_done(self, name: str) -> None:
        """As the sensor's driver says it."""
        self.vehicle.send_statustext(_DONE[name])
        if name == "baro" and self.vehicle.type in (VehicleType.PLANE, VehicleType.VTOL):
            self.vehicle.send_statustext("Airspeed 1 calibrated")

    def store(self, request: CommandRequest) -> common.MavResult:
        """PREFLIGHT_STORAGE: only the reset to defaults; parameters are saved as they are set."""
        if whole(request.command.param1) != _RESET:
            return _RESULT.DENIED
        self.vehicle.parameters.reset()
        self.vehicle.send_statustext("All parameters reset, reboot board", common.MavSeverity.WARNING)
        return _RESULT.ACCEPTED

    def test_motor(self, request: CommandRequest) -> Outcome:
        """DO_MOTOR_TEST."""
        result = super().test_motor(request)
        self.vehicle.send_statustext(
            "starting motor test" if result == _RESULT.ACCEPTED else "finished motor test"
        )
        return result
