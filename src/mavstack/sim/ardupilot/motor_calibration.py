"""Calibrations with running motors, and the pilot who handles the vehicle meanwhile: compass-motor and ESCs.

The compass-motor calibration passes the throttle on to the motors and reports their effect on the compass
until it receives any COMMAND_ACK. The simulated pilot raises the throttle slowly. ESC_CALIBRATION = 3
calibrates the ESCs at the next power-up; the simulated pilot disconnects and connects the battery.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_INFO: Final = common.MavSeverity.INFO
_STATUS_INTERVAL: Final = 0.5
#: Seconds in which the simulated pilot raises the throttle from zero to `_HALF_THROTTLE`.
_THROTTLE_TIME: Final = 5.0
_HALF_THROTTLE: Final = 0.5
#: The calibration succeeds only if the throttle was raised above this share.
_MIN_THROTTLE: Final = 0.05
#: Current in amperes, and interference in percent, at full throttle.
_CURRENT, _INTERFERENCE = 40.0, 24.0
ESC_PARAMETER: Final = "ESC_CALIBRATION"
_AUTOMATIC: Final = 3
#: Seconds after which the simulated pilot reconnects the battery, which reboots the vehicle.
_POWER_CYCLE_TIME: Final = 5.0


class CompassMotorCalibration:
    """The compass-motor calibration of a copter; one of its autopilot's watches."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        #: Time at which the calibration started; None if no calibration runs.
        self.started: float | None = None
        self._throttle = 0.0
        self._due = 0.0

    def begin(self) -> None:
        """Start."""
        self.started = self._due = self._autopilot.now
        self._throttle = 0.0
        for text in ("Starting calibration", "Current"):
            self._autopilot.vehicle.send_statustext(text, _INFO)

    def end(self) -> None:
        """Stop the motors, and report whether the throttle was raised."""
        if self.started is None:
            return
        self.started = None
        successful = self._throttle > _MIN_THROTTLE
        text, severity = (
            ("Calibration successful", _INFO) if successful else ("Failed", common.MavSeverity.NOTICE)
        )
        self._autopilot.vehicle.send_statustext(text, severity)

    def tick(self, now: float) -> None:
        """Raise the throttle, and report its effect."""
        if self.started is None:
            return
        self._throttle = _HALF_THROTTLE * min((now - self.started) / _THROTTLE_TIME, 1.0)
        if now >= self._due:
            self._due = now + _STATUS_INTERVAL
            interference = _INTERFERENCE * self._throttle
            self._autopilot.vehicle.services.send(
                ardupilotmega.CompassmotStatus(
                    throttle=round(self._throttle * 1000),
                    current=_CURRENT * self._throttle,
                    interference=round(interference),
                    CompensationX=interference,
                )
            )


class EscCalibration:
    """The calibration of the ESCs at power-up; one of a copter's watches, made at boot."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        vehicle = autopilot.vehicle
        self._reboot_at: float | None = None
        if vehicle.parameters.get(ESC_PARAMETER, 0) == _AUTOMATIC:
            vehicle.send_statustext("ESC calibration: Auto calibration", _INFO)
            vehicle.parameters.set(ESC_PARAMETER, 0)
        vehicle.parameters.on_change(ESC_PARAMETER, self._changed)

    def _changed(self, value: float) -> None:
        planned = value == _AUTOMATIC and not self._autopilot.armed
        self._reboot_at = self._autopilot.now + _POWER_CYCLE_TIME if planned else None

    def tick(self, now: float) -> None:
        """Connect the battery again."""
        if self._reboot_at is not None and now >= self._reboot_at:
            self._reboot_at = None
            self._autopilot.tasks.on_next_tick(self._autopilot.vehicle.reboot)


def compass_motor_of(autopilot: SimulatedAutopilot) -> CompassMotorCalibration | None:
    """Return the compass-motor calibration of a vehicle; None if its type has none."""
    return next((watch for watch in autopilot.watches if isinstance(watch, CompassMotorCalibration)), None)
