"""Calibrations by hand: accelerometers in six positions, compasses by rotation.

The accelerometer calibration requests six positions, every second as COMMAND_LONG with
MAV_CMD_ACCELCAL_VEHICLE_POS; the ground station confirms a position with the same command. Older ones
answer the status text of a position with a COMMAND_ACK; the texts end with the first ACCELCAL_VEHICLE_POS.
The result is repeated every second until the next calibration. A compass is rotated for some time, reported
by MAG_CAL_PROGRESS in two steps and finally MAG_CAL_REPORT, which is repeated; the result is accepted by
command, or was accepted automatically.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.services import Address
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_POSITIONS: Final = ("level", "on its LEFT side", "on its RIGHT side", "nose DOWN", "nose UP", "on its BACK")
_SUCCESS: Final = int(ardupilotmega.AccelcalVehiclePos.SUCCESS)
#: Older ground stations confirm a position by a COMMAND_ACK with a command up to this number and this result.
_MAX_ACK_COMMAND, _ACK_RESULT = 6, int(common.MavResult.TEMPORARILY_REJECTED)
_STATUS = ardupilotmega.MagCalStatus
_REQUEST_INTERVAL = 1.0
#: Seconds for which the accelerometers are measured in one position.
_SAMPLING_TIME = 0.5
_COMPASS_TIME = 10.0
_PROGRESS_INTERVAL = 0.5
#: Progress in percent at the end of the first and of the second step of the compass calibration.
_FIRST_STEP, _SECOND_STEP = 33, 99
_FITNESS, _SCALE = 5.0, 1.0
_COMPASSES = 0b1


class Calibrations:
    """Running calibrations; one of the autopilot's periodic checks."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        #: Requested position of the vehicle in the accelerometer calibration, 1 to 6; 0 if none is requested.
        self.position = 0
        #: Time at which the measurement in the present position ends; None until the position is confirmed.
        self._measured_at: float | None = None
        self._uses_texts = True
        #: The ground station that has to confirm the position by a COMMAND_ACK.
        self._awaited: Address | None = None
        self._starter: Address | None = None
        #: True once the accelerometers have been calibrated.
        self._succeeded = False
        #: Time at which the compass calibration started; None if no calibration runs.
        self.compass_started: float | None = None
        #: True if the result of a compass calibration waits for DO_ACCEPT_MAG_CAL.
        self.compass_ready = False
        self._auto_accept = False
        self._due = 0.0
        #: True while MAG_CAL_REPORT of the last compass calibration is sent repeatedly.
        self._reporting = False

    # Accelerometers

    def begin_accelerometers(self, starter: Address) -> None:
        """Request the first position; a calibration that runs goes on."""
        if self.position:
            return
        self._uses_texts, self._starter = True, starter
        self._request_position(1)

    def confirm_position(self, position: int) -> bool:
        """Continue with the next position; return False if this one was not requested."""
        self._uses_texts = False
        if not self.position or position != self.position or self._measured_at is not None:
            return False
        self._measured_at = self._autopilot.now + _SAMPLING_TIME
        return True

    def acknowledged(self, message: common.CommandAck, source: Address) -> None:
        """Take in a COMMAND_ACK, which older ground stations confirm a position with."""
        if source != self._awaited or not self.position:
            return
        if message.command <= _MAX_ACK_COMMAND and message.result == _ACK_RESULT:
            self._awaited = None
            self._measured_at = self._autopilot.now + _SAMPLING_TIME

    def _next_position(self) -> None:
        self._measured_at = None
        if self.position < len(_POSITIONS):
            self._request_position(self.position + 1)
        else:
            self.position, self._succeeded = 0, True
            self._autopilot.vehicle.send_statustext("Calibration successful", common.MavSeverity.CRITICAL)

    def _request_position(self, position: int) -> None:
        """Send the request for a position."""
        self.position, self._due = position, self._autopilot.now
        if self._uses_texts:
            text = f"Place vehicle {_POSITIONS[position - 1]} and press any key."
            self._autopilot.vehicle.send_statustext(text, common.MavSeverity.CRITICAL)
            self._awaited = self._starter

    def _send_position(self, position: int) -> None:
        """Send ACCELCAL_VEHICLE_POS."""
        command = ardupilotmega.MavCmd.ACCELCAL_VEHICLE_POS
        self._autopilot.vehicle.services.send(common.CommandLong(command=command, param1=float(position)))

    # Compasses

    def begin_compass(self, *, accept: bool) -> None:
        """Start the compass calibration."""
        self._reporting = False
        self.compass_started, self.compass_ready, self._auto_accept = self._autopilot.now, False, accept
        self._due = self._autopilot.now

    def accept_compass(self) -> bool:
        """Apply the result; return False if there is none."""
        done, self.compass_ready = self.compass_ready, False
        if done:
            self._autopilot.body.offset_compass(0.0)
        return done

    def cancel_compass(self) -> None:
        """Discard the calibration."""
        self._reporting = False
        self.compass_started, self.compass_ready = None, False

    # Periodic update

    def tick(self, now: float) -> None:
        """Repeat the request or the result, and report progress."""
        if self._measured_at is not None:
            if now >= self._measured_at:
                self._next_position()
            return
        if self._autopilot.armed or now < self._due:
            return
        if self.compass_started is not None:
            self._due = now + _PROGRESS_INTERVAL
            self._update_compass((now - self.compass_started) / _COMPASS_TIME)
            return
        self._due = now + _REQUEST_INTERVAL
        if self.position or self._succeeded:
            self._send_position(self.position or _SUCCESS)
        if self._reporting:
            self._autopilot.vehicle.services.send(self._report())

    def _update_compass(self, share: float) -> None:
        """Report the progress (0 to 1), and finish at 1."""
        if share < 1.0:
            percent = int(share * _SECOND_STEP)
            status = _STATUS.RUNNING_STEP_ONE if percent < _FIRST_STEP else _STATUS.RUNNING_STEP_TWO
            self._autopilot.vehicle.services.send(
                ardupilotmega.MagCalProgress(
                    cal_mask=_COMPASSES, cal_status=status, attempt=1, completion_pct=percent
                )
            )
            return
        self.compass_started, self.compass_ready = None, True
        if self._auto_accept:
            self.accept_compass()
        self._reporting = True

    def _report(self) -> common.MagCalReport:
        """Return MAG_CAL_REPORT."""
        parameters = self._autopilot.vehicle.parameters
        offsets = [float(parameters.get(f"COMPASS_OFS_{axis}", 0.0)) for axis in "XYZ"]
        return common.MagCalReport(
            cal_mask=_COMPASSES,
            cal_status=_STATUS.SUCCESS,
            autosaved=int(self._auto_accept),
            fitness=_FITNESS,
            ofs_x=offsets[0],
            ofs_y=offsets[1],
            ofs_z=offsets[2],
            diag_x=_SCALE,
            diag_y=_SCALE,
            diag_z=_SCALE,
        )


def calibrations_of(autopilot: SimulatedAutopilot) -> Calibrations:
    """Return the calibrations of a vehicle, created on first use."""
    found = next((watch for watch in autopilot.watches if isinstance(watch, Calibrations)), None)
    if found is None:
        found = Calibrations(autopilot)
        autopilot.watches.append(found)
    return found
