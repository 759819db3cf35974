"""Calibrations by hand: accelerometers in six positions, compasses by rotation.

The accelerometer calibration requests six positions, as a status text and every second as COMMAND_LONG with
MAV_CMD_ACCELCAL_VEHICLE_POS; the ground station answers with the same command, or any COMMAND_ACK, when the
vehicle is in position. A compass is rotated for some time, reported by MAG_CAL_PROGRESS and finally
MAG_CAL_REPORT; then the result is accepted, or was accepted automatically.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Autopilot

_POSITIONS: Final = (
    "level",
    "on its LEFT side",
    "on its RIGHT side",
    "nose DOWN",
    "nose UP",
    "on its BACK",
)
_SUCCESS: Final = int(ardupilotmega.AccelcalVehiclePos.SUCCESS)
_STATUS = ardupilotmega.MagCalStatus
_REQUEST_INTERVAL = 1.0
_COMPASS_TIME = 10.0
_PROGRESS_INTERVAL = 0.5
_FITNESS, _SCALE = 5.0, 1.0
_COMPASSES = 0b1
#: A report is repeated, since it may be lost.
_REPORTS = 5


class Calibrations:
    """Running calibrations; one of the autopilot's periodic checks."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        #: Requested accelerometer position, 1 to 6; 0 for none.
        self.position = 0
        #: Start of the compass calibration; None if not running.
        self.compass_started: float | None = None
        #: True if a compass calibration waits for acceptance.
        self.compass_ready = False
        self._auto_accept = False
        self._due = 0.0
        #: Reports of the last compass calibration that are left to send.
        self._reports = 0

    # Accelerometers

    def begin_accelerometers(self) -> None:
        """Request the first position."""
        self.position = 1
        self._request_position()

    def confirm_position(self, position: int | None = None) -> bool:
        """Continue with the next position; return False if this one was not requested."""
        if not self.position or position not in (None, self.position):
            return False
        if self.position < len(_POSITIONS):
            self.position += 1
            self._request_position()
        else:
            self.position = 0
            self._send_position(_SUCCESS)
            self._autopilot.vehicle.send_statustext("Calibration successful", common.MavSeverity.CRITICAL)
        return True

    def _request_position(self) -> None:
        """Send the request for a position."""
        text = f"Place vehicle {_POSITIONS[self.position - 1]} and press any key."
        self._autopilot.vehicle.send_statustext(text, common.MavSeverity.CRITICAL)
        self._due = self._autopilot.now

    def _send_position(self, position: int) -> None:
        """Send ACCELCAL_VEHICLE_POS."""
        command = ardupilotmega.MavCmd.ACCELCAL_VEHICLE_POS
        self._autopilot.vehicle.services.send(common.CommandLong(command=command, param1=float(position)))

    # Compasses

    def begin_compass(self, *, accept: bool) -> None:
        """Start the compass calibration."""
        self._reports = 0
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
        self._reports = 0
        self.compass_started, self.compass_ready = None, False

    # Time

    def tick(self, now: float) -> None:
        """Repeat the request, and report progress."""
        if self._autopilot.armed or now < self._due:
            return
        if self.position:
            self._due = now + _REQUEST_INTERVAL
            self._send_position(self.position)
        elif self.compass_started is not None:
            self._due = now + _PROGRESS_INTERVAL
            self._update_compass(min((now - self.compass_started) / _COMPASS_TIME, 1.0))
        elif self._reports:
            self._due = now + _REQUEST_INTERVAL
            self._reports -= 1
            self._autopilot.vehicle.services.send(self._report())

    def _update_compass(self, share: float) -> None:
        """Report the progress (0 to 1), and finish at 1."""
        services = self._autopilot.vehicle.services
        services.send(
            ardupilotmega.MagCalProgress(
                cal_mask=_COMPASSES,
                cal_status=_STATUS.RUNNING_STEP_ONE if share < 0.5 else _STATUS.RUNNING_STEP_TWO,
                attempt=1,
                completion_pct=int(share * 100),
            )
        )
        if share < 1.0:
            return
        self.compass_started, self.compass_ready = None, True
        if self._auto_accept:
            self.accept_compass()
        self._reports = _REPORTS

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


def calibrations_of(autopilot: Autopilot) -> Calibrations:
    """Return the calibrations of a vehicle, created on first use."""
    found = next((watch for watch in autopilot.watches if isinstance(watch, Calibrations)), None)
    if found is None:
        found = Calibrations(autopilot)
        autopilot.watches.append(found)
    return found
