"""The calibrations that need the pilot's hands: accelerometers in six positions, compasses by turning.

The accelerometers want the vehicle laid down in six ways; which comes next is said as a text and, once a
second, as COMMAND_LONG with MAV_CMD_ACCELCAL_VEHICLE_POS, and the ground station answers with the same
command, or with any COMMAND_ACK, when it lies so. A compass is turned until enough was seen: that takes a
while, told by MAG_CAL_PROGRESS and at the end by MAG_CAL_REPORT; then it is accepted, or was at once.
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
_SAID_AGAIN = 1.0
_TURNING_TIME = 10.0
_PROGRESS_INTERVAL = 0.5
_FITNESS, _SCALE = 5.0, 1.0
_COMPASSES = 0b1


class Calibrations:
    """What is calibrated now; one of the autopilot's watches."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        #: Position of the accelerometers that is waited for, 1 to 6; 0: none.
        self.position = 0
        #: When the compass began to be turned; None: it is not.
        self.turned_since: float | None = None
        #: Whether a compass calibration waits to be accepted.
        self.compass_done = False
        self._accepts_by_itself = False
        self._due = 0.0

    # Accelerometers

    def begin_accelerometers(self) -> None:
        """Ask for the first position."""
        self.position = 1
        self._ask()

    def placed(self, position: int | None = None) -> bool:
        """The vehicle lies as it was asked; False if nothing was, or something else."""
        if not self.position or position not in (None, self.position):
            return False
        if self.position < len(_POSITIONS):
            self.position += 1
            self._ask()
        else:
            self.position = 0
            self._send_position(_SUCCESS)
            self._autopilot.vehicle.send_statustext("Calibration successful", common.MavSeverity.CRITICAL)
        return True

    def _ask(self) -> None:
        text = f"Place vehicle {_POSITIONS[self.position - 1]} and press any key."
        self._autopilot.vehicle.send_statustext(text, common.MavSeverity.CRITICAL)
        self._due = self._autopilot.now

    def _send_position(self, position: int) -> None:
        command = ardupilotmega.MavCmd.ACCELCAL_VEHICLE_POS
        self._autopilot.vehicle.services.send(common.CommandLong(command=command, param1=float(position)))

    # Compasses

    def begin_compass(self, *, accept: bool) -> None:
        """Turn it."""
        self.turned_since, self.compass_done, self._accepts_by_itself = self._autopilot.now, False, accept
        self._due = self._autopilot.now

    def accept_compass(self) -> bool:
        """Take what was found; False if nothing was."""
        done, self.compass_done = self.compass_done, False
        if done:
            self._autopilot.body.offset_compass(0.0)
        return done

    def cancel_compass(self) -> None:
        """Leave everything as it was."""
        self.turned_since, self.compass_done = None, False

    # Time

    def tick(self, now: float) -> None:
        """Say again what is waited for, and how far it is."""
        if self._autopilot.armed or now < self._due:
            return
        if self.position:
            self._due = now + _SAID_AGAIN
            self._send_position(self.position)
        elif self.turned_since is not None:
            self._due = now + _PROGRESS_INTERVAL
            self._turn(min((now - self.turned_since) / _TURNING_TIME, 1.0))

    def _turn(self, share: float) -> None:
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
        self.turned_since, self.compass_done = None, True
        if self._accepts_by_itself:
            self.accept_compass()
        services.send(self._report())

    def _report(self) -> common.MagCalReport:
        parameters = self._autopilot.vehicle.parameters
        offsets = [float(parameters.get(f"COMPASS_OFS_{axis}", 0.0)) for axis in "XYZ"]
        return common.MagCalReport(
            cal_mask=_COMPASSES,
            cal_status=_STATUS.SUCCESS,
            autosaved=int(self._accepts_by_itself),
            fitness=_FITNESS,
            ofs_x=offsets[0],
            ofs_y=offsets[1],
            ofs_z=offsets[2],
            diag_x=_SCALE,
            diag_y=_SCALE,
            diag_z=_SCALE,
        )


def calibrations_of(autopilot: Autopilot) -> Calibrations:
    """The calibrations of a vehicle, begun with the first one."""
    found = next((watch for watch in autopilot.watches if isinstance(watch, Calibrations)), None)
    if found is None:
        found = Calibrations(autopilot)
        autopilot.watches.append(found)
    return found
