"""Commands of maintenance on the ground: reboot, calibration, storage, motor tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.commands.registration import CommandGroup, Handlers, Outcome, waiting, whole
from mavstack.sim.autopilot.refusal import CommandRefusedError

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.autopilot.tasks import Script

_CMD, _RESULT = common.MavCmd, common.MavResult
_REBOOT, _SHUT_DOWN, _STAY_IN_BOOTLOADER = 1, 2, 3
_LOAD, _SAVE, _RESET = 0, 1, 2
FORCE = 20190226.0
#: Duration of each calibration, in seconds.
_CALIBRATION_TIME = 2.0
MAX_MOTOR_TEST_TIME = 600.0
_MOTORS = 8


class MaintenanceCommands(CommandGroup):
    """PREFLIGHT_REBOOT_SHUTDOWN, PREFLIGHT_CALIBRATION, PREFLIGHT_STORAGE, DO_MOTOR_TEST."""

    def handlers(self) -> Handlers:
        return {
            _CMD.PREFLIGHT_REBOOT_SHUTDOWN: self.reboot,
            _CMD.PREFLIGHT_CALIBRATION: self.calibrate,
            _CMD.PREFLIGHT_STORAGE: self.store,
            _CMD.DO_MOTOR_TEST: self.test_motor,
        }

    # Reboot

    def reboot(self, request: CommandRequest) -> common.MavResult:
        """PREFLIGHT_REBOOT_SHUTDOWN: send the answer, then reboot."""
        wanted = whole(request.command.param1)
        if self.autopilot.armed and request.command.param6 != FORCE:
            return self.refuse_reboot()
        if wanted not in self.reboots:
            return _RESULT.UNSUPPORTED
        self.restart(wanted)
        return _RESULT.ACCEPTED

    def restart(self, wanted: int | None) -> None:
        """Restart after the answer was sent, as param 1 says."""
        to_bootloader = wanted == _STAY_IN_BOOTLOADER
        self.autopilot.tasks.on_next_tick(
            self.vehicle.reboot_into_bootloader if to_bootloader else self.vehicle.reboot
        )

    #: The accepted values of param 1 of PREFLIGHT_REBOOT_SHUTDOWN.
    reboots = frozenset({_REBOOT, _STAY_IN_BOOTLOADER})

    def refuse_reboot(self) -> common.MavResult:
        """Return the answer of an armed vehicle."""
        return _RESULT.FAILED

    # Calibration

    def calibrate(self, request: CommandRequest) -> Outcome:
        """PREFLIGHT_CALIBRATION: calibrate the sensors one after another, on the ground."""
        if self.autopilot.armed:
            return self.refuse_calibration()
        wanted = self.requested_calibrations(request)
        if not wanted:
            return _RESULT.UNSUPPORTED
        self.autopilot.tasks.begin(request, self.calibrating(wanted))
        return None

    def refuse_calibration(self) -> common.MavResult:
        """Return the answer of an armed vehicle."""
        raise CommandRefusedError(_RESULT.FAILED, "Disarm to allow calibration")

    def requested_calibrations(self, request: CommandRequest) -> list[str]:
        """Return the names of the calibrations that a command requests."""
        command = request.command
        named = {
            "gyro": command.param1,
            "mag": command.param2,
            "baro": command.param3,
            "radio": command.param4,
            "accel": command.param5,
        }
        return [name for name, value in named.items() if whole(value)]

    def calibrating(self, wanted: list[str]) -> Script:
        """Calibrate sensors, and announce it."""
        for name in wanted:
            self.announce_start(name)
            yield from waiting(self.vehicle, _CALIBRATION_TIME)
            self.announce_end(name)
        return _RESULT.ACCEPTED

    def announce_start(self, name: str) -> None:
        """Announce the start of a calibration."""
        self.vehicle.send_statustext(f"Calibrating {name}")

    def announce_end(self, name: str) -> None:
        """Announce the end of a calibration."""
        self.vehicle.send_statustext(f"{name.capitalize()} calibration done")

    # Storage

    def store(self, request: CommandRequest) -> common.MavResult:
        """PREFLIGHT_STORAGE: reset parameters to defaults; they are saved whenever they are set."""
        wanted = whole(request.command.param1)
        if wanted == _RESET:
            self.vehicle.parameters.reset()
            return _RESULT.ACCEPTED
        return _RESULT.ACCEPTED if wanted in (_LOAD, _SAVE) else _RESULT.UNSUPPORTED

    # Motors

    def test_motor(self, request: CommandRequest) -> Outcome:
        """DO_MOTOR_TEST: run a motor for a while, or send why not; 0 seconds end the test."""
        motor, seconds = whole(request.command.param1), request.command.param4
        if self.autopilot.armed or not self.autopilot.landed or motor is None or not 1 <= motor <= _MOTORS:
            raise CommandRefusedError(_RESULT.FAILED, self.motor_test_refused())
        if not 0 <= seconds <= MAX_MOTOR_TEST_TIME:
            return _RESULT.FAILED
        self.autopilot.payload.test_motor(motor, request.command.param3, seconds)
        return _RESULT.ACCEPTED

    def motor_test_refused(self) -> str:
        """Return the text of a refused motor test."""
        reason = "not allowed now" if self.autopilot.landed else "vehicle not landed"
        return f"Motor Test: {reason}"
