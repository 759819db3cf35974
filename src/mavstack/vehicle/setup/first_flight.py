"""The check list before a first flight: settings that are done, missing or advised, and how to mend them.

It is advice from the parameters and the telemetry; the vehicle's own checks decide whether it arms.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.vehicle.firmware import firmware_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from mavstack.dialects import Message
    from mavstack.vehicle.vehicle import Vehicle

#: The messages that the items of telemetry read.
_REPORTS: Final = (common.GpsRawInt, common.SysStatus, common.BatteryStatus)
#: Seconds to wait for one of them.
_REPORT_TIMEOUT: Final = 5.0
_MIN_SATELLITES: Final = 8
_MIN_REMAINING: Final = 80
#: The smallest GPS_FIX_TYPE of a fix that has an altitude.
_MIN_FIX: Final = 3
#: ArduPilot's default pulse widths of a receiver, before its calibration.
_UNCALIBRATED: Final = (1100.0, 1900.0)

Values: TypeAlias = "Mapping[str, float]"


class CheckState(StrEnum):
    """The state of an item of the check list."""

    OK = "ok"
    MISSING = "missing"
    ADVICE = "advice"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class CheckItem:
    """An item of the check list.

    Attributes:
        name: The subject, such as "compass".
        state: Whether it is set up.
        text: The finding.
        remedy: What to do; empty if nothing.
    """

    name: str
    state: CheckState
    text: str
    remedy: str = ""

    def __str__(self) -> str:
        remedy = f"; {self.remedy}" if self.remedy else ""
        return f"{self.name}: {self.state}, {self.text}{remedy}"


@dataclass(frozen=True, slots=True)
class _Row:
    """A check of parameters.

    Attributes:
        name: The subject.
        parameters: The parameters; the check is unknown if the vehicle has none of them.
        holds: Returns whether it is set up, by the values of those that the vehicle has.
        good: The text if it is.
        bad: The text if it is not.
        remedy: What to do then.
        state: The state then.
    """

    name: str
    parameters: tuple[str, ...]
    holds: Callable[[Sequence[float]], bool]
    good: str
    bad: str
    remedy: str
    state: CheckState = CheckState.MISSING


def _calibrated_sticks(values: Sequence[float]) -> bool:
    return tuple(values) != _UNCALIBRATED


_PX4: Final = (
    _Row("airframe", ("SYS_AUTOSTART",), all, "selected", "not selected", "mav vehicle airframe"),
    _Row(
        "accelerometer", ("CAL_ACC0_ID",), all, "calibrated", "not calibrated",
        "mav vehicle calibrate accelerometer",
    ),
    _Row("gyroscope", ("CAL_GYRO0_ID",), all, "calibrated", "not calibrated",
        "mav vehicle calibrate gyroscope"),
    _Row("compass", ("CAL_MAG0_ID",), all, "calibrated", "not calibrated", "mav vehicle calibrate compass"),
    _Row(
        "receiver", ("RC_CHAN_CNT", "COM_RC_IN_MODE"), any, "calibrated, or replaced by a joystick",
        "not calibrated", "calibrate the radio, or set COM_RC_IN_MODE 1 for a joystick",
    ),
    _Row(
        "loss of the radio", ("NAV_RCL_ACT",), all, "the vehicle acts", "nothing happens",
        "set NAV_RCL_ACT, such as 2 for a return",
    ),
    _Row(
        "loss of the ground station", ("NAV_DLL_ACT",), all, "the vehicle acts", "nothing happens",
        "set NAV_DLL_ACT if it flies without a radio", CheckState.ADVICE,
    ),
    _Row(
        "low battery", ("COM_LOW_BAT_ACT",), all, "the vehicle acts", "the vehicle only warns",
        "set COM_LOW_BAT_ACT, such as 3",
    ),
    _Row(
        "geofence", ("GF_ACTION",), all, "the vehicle acts at its limits", "has no effect",
        "set GF_ACTION and GF_MAX_HOR_DIST", CheckState.ADVICE,
    ),
)  # fmt: skip
_ARDUPILOT: Final = (
    _Row("airframe", ("FRAME_CLASS",), all, "selected", "not selected", "mav vehicle airframe"),
    _Row(
        "accelerometer", ("INS_ACCOFFS_X", "INS_ACCOFFS_Y", "INS_ACCOFFS_Z"), any, "calibrated",
        "not calibrated", "mav vehicle calibrate accelerometer",
    ),
    _Row(
        "compass", ("COMPASS_OFS_X", "COMPASS_OFS_Y", "COMPASS_OFS_Z"), any, "calibrated", "not calibrated",
        "mav vehicle calibrate compass",
    ),
    _Row(
        "receiver", ("RC1_MIN", "RC1_MAX"), _calibrated_sticks, "calibrated", "not calibrated",
        "calibrate the radio",
    ),
    _Row(
        "battery", ("BATT_MONITOR",), all, "measured", "not measured", "set BATT_MONITOR, such as 4",
    ),
    _Row(
        "loss of the radio", ("FS_THR_ENABLE", "THR_FAILSAFE", "FS_PILOT_INPUT"), any, "the vehicle acts",
        "nothing happens", "set the throttle failsafe, such as FS_THR_ENABLE 1",
    ),
    _Row(
        "low battery", ("BATT_FS_LOW_ACT",), all, "the vehicle acts", "nothing happens",
        "set BATT_FS_LOW_ACT and BATT_LOW_VOLT",
    ),
    _Row(
        "loss of the ground station", ("FS_GCS_ENABLE", "FS_GCS_ENABL"), any, "the vehicle acts",
        "nothing happens", "set FS_GCS_ENABLE if it flies without a radio", CheckState.ADVICE,
    ),
    _Row(
        "geofence", ("FENCE_ENABLE",), all, "on", "off", "set FENCE_ENABLE 1 and its limits",
        CheckState.ADVICE,
    ),
)  # fmt: skip
_ROWS: Final[Mapping[int, tuple[_Row, ...]]] = MappingProxyType(
    {common.MavAutopilot.PX4: _PX4, common.MavAutopilot.ARDUPILOTMEGA: _ARDUPILOT}
)


async def first_flight(vehicle: Vehicle) -> tuple[CheckItem, ...]:
    """Return the check list of a vehicle; parameters and reports that are not known yet are requested.

    Args:
        vehicle: The vehicle.

    Returns:
        The items: parameters, then telemetry, then the vehicle's own checks.

    Raises:
        RemoteError: The parameters cannot be downloaded.
    """
    if firmware_of(vehicle).FEATURES.get("parameters", True) and not vehicle.params.is_complete:
        await vehicle.params.download()
    await _request_reports(vehicle)
    values = {name: each.value for name, each in vehicle.params.cached.items()}
    return (*parameter_checks(int(vehicle.autopilot or 0), values), *_telemetry_checks(vehicle))


async def _request_reports(vehicle: Vehicle) -> None:
    """Request the reports that the check list reads, of those that have not arrived yet."""

    async def request(kind: type[Message]) -> None:
        with suppress(MavstackError):  # a vehicle without this sensor denies it
            await vehicle.component.request_message(kind, timeout=_REPORT_TIMEOUT)

    telemetry = vehicle.telemetry
    missing = [kind for kind in _REPORTS if telemetry.latest(kind) is None]
    # vehicles send their home by themselves only when it changes
    await asyncio.gather(telemetry.request_home(), *map(request, missing))


def parameter_checks(autopilot: int, values: Values) -> Iterator[CheckItem]:
    """Yield the items that follow from the parameters of a firmware.

    Args:
        autopilot: Its MAV_AUTOPILOT.
        values: The values of all parameters by name.

    Yields:
        The items; those of which the vehicle has no parameter are left out.
    """
    for row in _ROWS.get(autopilot, ()):
        held = [values[name] for name in row.parameters if name in values]
        if not held:
            continue
        if row.holds(held):
            yield CheckItem(row.name, CheckState.OK, row.good)
        else:
            yield CheckItem(row.name, row.state, row.bad, row.remedy)


def _telemetry_checks(vehicle: Vehicle) -> Iterator[CheckItem]:
    yield _saved(vehicle)
    yield _position(vehicle)
    yield _battery(vehicle)
    yield _home(vehicle)
    yield from _own_checks(vehicle)


def _saved(vehicle: Vehicle) -> CheckItem:
    names = vehicle.params.unsaved
    if not names:
        return CheckItem("settings", CheckState.OK, "saved")
    return CheckItem(
        "settings", CheckState.MISSING, f"{len(names)} are not yet saved", "save them: mav param set … --save"
    )


def _position(vehicle: Vehicle) -> CheckItem:
    gps = vehicle.gps
    if gps is None:
        return CheckItem("position", CheckState.UNKNOWN, "no receiver reports", "connect a GPS receiver")
    satellites = gps.satellites or 0
    if gps.fix >= _MIN_FIX and satellites >= _MIN_SATELLITES:
        return CheckItem("position", CheckState.OK, f"{satellites} satellites")
    return CheckItem(
        "position", CheckState.MISSING, f"{satellites} satellites, no sure fix", "wait, with free sky"
    )


def _battery(vehicle: Vehicle) -> CheckItem:
    battery = vehicle.battery
    if battery is None or battery.remaining is None:
        return CheckItem("charge", CheckState.UNKNOWN, "not reported", "set up the battery monitor")
    state = CheckState.OK if battery.remaining >= _MIN_REMAINING else CheckState.MISSING
    return CheckItem(
        "charge", state, f"{battery.remaining:.0f} %", "" if state is CheckState.OK else "charge it"
    )


def _home(vehicle: Vehicle) -> CheckItem:
    if vehicle.home is not None:
        return CheckItem("home", CheckState.OK, "set")
    return CheckItem(
        "home", CheckState.UNKNOWN, "not reported", "the vehicle sets it with its first position"
    )


def _own_checks(vehicle: Vehicle) -> Iterator[CheckItem]:
    """Yield the result of the vehicle's checks before arming."""
    health = vehicle.health
    if health.ready:
        yield CheckItem("ready to arm", CheckState.OK, "the vehicle says so")
    elif health.ready is None:
        yield CheckItem("ready to arm", CheckState.UNKNOWN, "the vehicle does not report it")
    for problem in health.problems:
        yield CheckItem("ready to arm", CheckState.MISSING, problem.text)
