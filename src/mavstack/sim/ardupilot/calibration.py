"""ArduPilot's ground commands: calibration, parameters, reboot, motor tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.motor_calibration import CompassMotorCalibration, compass_motor_of
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
_END_TEXTS = {
    "gyro": "Gyro calibration successful",
    "baro": "Barometer calibration complete",
    "accel": "Accelerometer calibration successful",
    "level": "Trim OK: roll=0.00 pitch=0.00 yaw=0.00",
}
_START_TEXTS = {
    "baro": "Updating barometer calibration",
    "gyro": "Calibrating gyros",
    "accel": "Calibrating accelerometers",
}


class ArdupilotMaintenance(MaintenanceCommands):
    """Ground commands with ArduPilot's answers and status texts."""

    def handlers(self) -> Handlers:
        handlers = {
            **super().handlers(),
            _CMD.DO_START_MAG_CAL: self.start_compass,
            _CMD.DO_ACCEPT_MAG_CAL: self.accept_compass,
            _CMD.DO_CANCEL_MAG_CAL: self.cancel_compass,
            _CMD.ACCELCAL_VEHICLE_POS: self.confirm_position,
        }
        if self.vehicle.vehicle_type is VehicleType.PLANE:
            del handlers[_CMD.DO_MOTOR_TEST]
        return handlers

    def refuse_calibration(self) -> common.MavResult:
        """Refuse a calibration while armed."""
        raise CommandRefusedError(_RESULT.FAILED, "Disarm to allow calibration")

    def calibrate(self, request: CommandRequest) -> Outcome:
        """Answer PREFLIGHT_CALIBRATION.

        param5 = 1 starts the accelerometer calibration in six positions, param6 = 1 the one of compass and
        motors.
        """
        if whole(request.command.param5) == _SIX_POSITIONS and not self.autopilot.armed:
            calibrations_of(self.autopilot).begin_accelerometers(request.source)
            return _RESULT.ACCEPTED
        compass_motor = compass_motor_of(self.autopilot)
        if compass_motor is not None and whole(request.command.param6) == 1 and not self.autopilot.armed:
            return self.begin_compass_motor(compass_motor)
        return super().calibrate(request)

    def begin_compass_motor(self, calibration: CompassMotorCalibration) -> common.MavResult:
        """Start the calibration of compass and motors, or refuse it with the reason."""
        if calibration.started is not None:
            return _RESULT.TEMPORARILY_REJECTED
        for refused, reason in (
            (not self.vehicle.parameters.get("COMPASS_ENABLE", 1), "Compass disabled"),
            (self.autopilot.radio.sticks.throttle > 0, "Throttle not zero"),
            (not self.autopilot.landed, "Not landed"),
        ):
            if refused:
                raise CommandRefusedError(_RESULT.TEMPORARILY_REJECTED, reason)
        calibration.begin()
        return _RESULT.ACCEPTED

    def confirm_position(self, request: CommandRequest) -> common.MavResult:
        """Answer ACCELCAL_VEHICLE_POS: the vehicle is in the requested position."""
        position = whole(request.command.param1)
        return accept(position is not None and calibrations_of(self.autopilot).confirm_position(position))

    def start_compass(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_START_MAG_CAL; param3 = 1 accepts the result automatically."""
        if self.autopilot.armed:
            raise CommandRefusedError(_RESULT.FAILED, "Disarm to allow compass calibration")
        calibrations_of(self.autopilot).begin_compass(accept=request.command.param3 == 1)
        return _RESULT.ACCEPTED

    def accept_compass(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_ACCEPT_MAG_CAL."""
        return accept(calibrations_of(self.autopilot).accept_compass())

    def cancel_compass(self, request: CommandRequest) -> common.MavResult:
        """Answer DO_CANCEL_MAG_CAL."""
        calibrations_of(self.autopilot).cancel_compass()
        return _RESULT.ACCEPTED

    def requested_calibrations(self, request: CommandRequest) -> list[str]:
        """Return the supported calibrations that a command requests."""
        command = request.command
        requested = []
        if command.param1 == 1:
            requested.append("gyro")
        if command.param3 == 1:
            requested.append("baro")
        if whole(command.param5) == _LEVEL:
            requested.append("level")
        elif whole(command.param5) == _SIMPLE_ACCEL:
            requested.append("accel")
        return requested

    def announce_start(self, name: str) -> None:
        """Report the start as the sensor's driver does."""
        if name in _START_TEXTS:
            self.vehicle.send_statustext(_START_TEXTS[name])

    def announce_end(self, name: str) -> None:
        """Report the end as the sensor's driver does."""
        self.vehicle.send_statustext(_END_TEXTS[name])
        if name == "baro" and self.vehicle.vehicle_type in (VehicleType.PLANE, VehicleType.VTOL):
            self.vehicle.send_statustext("Airspeed 1 calibrated")

    def store(self, request: CommandRequest) -> common.MavResult:
        """Answer PREFLIGHT_STORAGE: only the reset to defaults; parameters are always saved."""
        if whole(request.command.param1) != _RESET:
            return _RESULT.DENIED
        self.vehicle.parameters.reset()
        self.vehicle.send_statustext("All parameters reset, reboot board", common.MavSeverity.WARNING)
        return _RESULT.ACCEPTED

    def test_motor(self, request: CommandRequest) -> Outcome:
        """Answer DO_MOTOR_TEST."""
        result = super().test_motor(request)
        self.vehicle.send_statustext(
            "starting motor test" if result == _RESULT.ACCEPTED else "finished motor test"
        )
        return result
