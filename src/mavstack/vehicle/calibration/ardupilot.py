"""ArduPilot's calibrations.

gyroscope, level, barometer, airspeed   PREFLIGHT_CALIBRATION, acknowledged at the end
accelerometer   the vehicle requests one pose after the other by ACCELCAL_VEHICLE_POS, once per second, and
the same command confirms it; the last request says whether it succeeded
compass         DO_START_MAG_CAL, MAG_CAL_PROGRESS and MAG_CAL_REPORT of each compass
compass-motor   PREFLIGHT_CALIBRATION, COMPASSMOT_STATUS until any COMMAND_ACK ends it, then a status text
esc             ESC_CALIBRATION = 3 calibrates at the next power-up, and is 0 then
radio           RC_CHANNELS and parameters, see `radio`
"""

from __future__ import annotations

import re
from contextlib import suppress
from math import inf
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias, cast

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import CommandDenied
from mavstack.services.heartbeat import ComponentFound, ComponentRebooted, ComponentReturned
from mavstack.vehicle.calibration.conversation import TURN_TIMEOUT
from mavstack.vehicle.calibration.kinds import (
    CalibrationKind,
    CalibrationResult,
    CalibrationTask,
    CompassFit,
    Pose,
)
from mavstack.vehicle.calibration.procedure import Procedure
from mavstack.vehicle.calibration.radio import calibrate_radio
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.vehicle.calibration.conversation import Conversation
    from mavstack.vehicle.vehicle import Vehicle

_Back: TypeAlias = ComponentRebooted | ComponentReturned | ComponentFound

_CMD: Final = ardupilotmega.MavCmd
_POSITION: Final = ardupilotmega.AccelcalVehiclePos
_COMPASS: Final = ardupilotmega.MagCalStatus
_ARGUMENTS: Final[Mapping[CalibrationKind, tuple[int, ...]]] = MappingProxyType(
    {
        CalibrationKind.GYROSCOPE: (1,),
        CalibrationKind.BAROMETER: (0, 0, 1),
        CalibrationKind.AIRSPEED: (0, 0, 1),
        CalibrationKind.ACCELEROMETER: (0, 0, 0, 0, 1),
        CalibrationKind.LEVEL: (0, 0, 0, 0, 2),
        CalibrationKind.COMPASS_MOTOR: (0, 0, 0, 0, 0, 1),
        CalibrationKind.RADIO: (0, 0, 0, 1),
    }
)
_POSES: Final[Mapping[int, Pose]] = MappingProxyType(
    {
        _POSITION.LEVEL: Pose.LEVEL,
        _POSITION.LEFT: Pose.LEFT,
        _POSITION.RIGHT: Pose.RIGHT,
        _POSITION.NOSEDOWN: Pose.NOSE_DOWN,
        _POSITION.NOSEUP: Pose.NOSE_UP,
        _POSITION.BACK: Pose.BACK,
    }
)
#: The rate of MAG_CAL_PROGRESS and MAG_CAL_REPORT, in hertz.
_COMPASS_RATE: Final = 2.0
_ESC_PARAMETER: Final = "ESC_CALIBRATION"
_CALIBRATE_AT_POWER_UP: Final = 3
_RAISE_THROTTLE: Final = "Raise the throttle slowly, lower it again, then confirm."
_HOLD_STILL: Final = "Hold the vehicle still."
_AIRSPEED: Final = re.compile(r"Airspeed (\d+) (calibration started|calibrated|unhealthy)")
#: The time after which the calibration of the airspeed sensors has ended even without a status text, in
#: seconds.
_AIRSPEED_TIME: Final = 15.0


async def _simple(conversation: Conversation) -> None:
    """Calibrate what needs one command."""
    text = "Keep the vehicle level and still." if conversation.kind is CalibrationKind.LEVEL else _HOLD_STILL
    conversation.emit_step(CalibrationTask.HOLD_STILL, text)
    await conversation.start(*_ARGUMENTS[conversation.kind], progress=text)
    conversation.running = False


async def _airspeed(conversation: Conversation) -> None:
    """Calibrate the airspeed sensors; earlier versions acknowledge the start, and report the end by text."""
    started: set[str] = set()
    ended: set[str] = set()

    def on_text(text: str) -> None:
        if found := _AIRSPEED.match(text):
            (started if found[2] == "calibration started" else ended).add(found[1])
            if found[2] == "unhealthy":
                conversation.problem = f"airspeed sensor {found[1]} is unhealthy"

    conversation.on_text = on_text
    text = "Keep the wind off the pitot tube."
    conversation.emit_step(CalibrationTask.SHIELD_PITOT, text)
    await conversation.start(*_ARGUMENTS[conversation.kind], progress=text)
    now = conversation.vehicle.connection.now
    late = now() + _AIRSPEED_TIME  # the text that reports the end may be lost
    await conversation.wait(lambda: started <= ended or now() >= late)
    conversation.running = False


async def _accelerometer(conversation: Conversation) -> None:
    requested: list[int] = []

    def receive(message: Message) -> None:
        match message:
            case common.CommandLong(command=_CMD.ACCELCAL_VEHICLE_POS, param1=position):
                # ArduPilot repeats the result of an earlier calibration until it requests a position.
                if requested or position in _POSES:
                    requested.append(int(position))

    conversation.listen(common.CommandLong, receive)
    await conversation.start(*_ARGUMENTS[conversation.kind])
    latest = 0
    while latest < len(_POSES):
        done = latest
        await conversation.wait(lambda: bool(requested) and requested[-1] != done)  # noqa: B023
        latest = requested[-1]
        if latest not in _POSES:
            break
        pose, share = _POSES[latest], 100 * (latest - 1) // len(_POSES)
        text = f"Place the vehicle {pose}, hold it still, and confirm."
        conversation.emit_step(
            CalibrationTask.PLACE, text, pose=pose, progress=share, needs_confirmation=True
        )
        await conversation.wait_for_confirmation()
        conversation.emit_step(CalibrationTask.HOLD_STILL, _HOLD_STILL, pose=pose, progress=share)
        await conversation.command(_CMD.ACCELCAL_VEHICLE_POS, latest)
    await conversation.wait(lambda: requested[-1] not in _POSES)
    conversation.running = False
    if requested[-1] != _POSITION.SUCCESS:
        raise conversation.failure("the vehicle could not calibrate from these poses")
    conversation.result = CalibrationResult(conversation.kind, reboot_needed=True)


async def _compass(conversation: Conversation) -> None:
    done: dict[int, int] = {}
    reports: dict[int, common.MagCalReport] = {}
    mask = 0

    def progressed(message: Message) -> None:
        nonlocal mask
        progress = cast("ardupilotmega.MagCalProgress", message)
        mask |= progress.cal_mask
        done[progress.compass_id] = progress.completion_pct
        text = "Rotate the vehicle slowly around all of its axes."
        conversation.emit_step(CalibrationTask.ROTATE, text, progress=min(done.values()))

    def reported(message: Message) -> None:
        nonlocal mask
        report = cast("common.MagCalReport", message)
        if report.compass_id in done:  # otherwise the report belongs to an earlier calibration
            mask |= report.cal_mask
            reports[report.compass_id] = report

    for message in (ardupilotmega.MagCalProgress, common.MagCalReport):
        await conversation.vehicle.telemetry.ensure(message, _COMPASS_RATE)
    await conversation.command(_CMD.DO_START_MAG_CAL, 0, 0, 1)
    conversation.listen(ardupilotmega.MagCalProgress, progressed)
    conversation.listen(common.MagCalReport, reported)
    await conversation.wait(
        lambda: bool(reports) and all(mask >> each & 1 == 0 or each in reports for each in range(8)),
        TURN_TIMEOUT,
    )
    conversation.running = False
    failed = {each.compass_id: each for each in reports.values() if each.cal_status != _COMPASS.SUCCESS}
    if failed:
        raise conversation.failure("; ".join(_failure(report) for report in failed.values()))
    fits = tuple(_fit(report) for _, report in sorted(reports.items()))
    conversation.result = CalibrationResult(conversation.kind, reboot_needed=True, compasses=fits)


def _failure(report: common.MagCalReport) -> str:
    status = report.cal_status
    name = status.name if isinstance(status, common.MagCalStatus) else f"status {int(status)}"
    return f"compass {report.compass_id}: {name}"


def _fit(report: common.MagCalReport) -> CompassFit:
    offsets = (report.ofs_x, report.ofs_y, report.ofs_z)
    return CompassFit(report.compass_id, report.fitness, offsets, bool(report.autosaved))


async def _compass_motor(conversation: Conversation) -> None:
    ended = False

    def on_text(text: str) -> None:
        nonlocal ended
        if text == "Failed":
            conversation.problem = "the throttle was not raised enough"
        ended = ended or text == "Calibration successful"

    def receive(message: Message) -> None:
        status = cast("ardupilotmega.CompassmotStatus", message)
        effect = f"{status.interference} % interference at {status.current:.0f} A"
        conversation.emit_step(
            CalibrationTask.RAISE_THROTTLE, f"{_RAISE_THROTTLE} {effect}.", needs_confirmation=True
        )

    conversation.armed = None  # armed or not, because this calibration runs the motors
    conversation.on_text = on_text
    await conversation.start(*_ARGUMENTS[conversation.kind])
    conversation.emit_step(CalibrationTask.RAISE_THROTTLE, _RAISE_THROTTLE, needs_confirmation=True)
    conversation.listen(ardupilotmega.CompassmotStatus, receive)
    await conversation.wait_for_confirmation()
    await _cancel_compass_motor(conversation.vehicle)
    await conversation.wait(lambda: ended)
    conversation.running = False


async def _esc(conversation: Conversation) -> None:
    vehicle = conversation.vehicle
    back = False
    await vehicle.params.set(_ESC_PARAMETER, _CALIBRATE_AT_POWER_UP)
    conversation.running = True
    text = "Take the propellers off. Disconnect battery and USB, connect the battery, and wait for the tones."
    kinds: tuple[type[_Back], ...] = (ComponentRebooted, ComponentReturned, ComponentFound)
    async with vehicle.connection.events(*kinds) as events:

        def is_back() -> bool:
            nonlocal back
            back = back or any(event.component.address == vehicle.address for event in events.drain())
            return back

        conversation.emit_step(CalibrationTask.CONNECT_BATTERY, text)
        await conversation.wait(is_back, inf, may_be_silent=True)
    value = (await vehicle.params.get(_ESC_PARAMETER)).value
    if value == _CALIBRATE_AT_POWER_UP:
        raise conversation.failure("the vehicle was restarted without a calibration; connect the battery")
    conversation.running = False
    conversation.result = CalibrationResult(conversation.kind, reboot_needed=True)


async def _radio(conversation: Conversation) -> None:
    async def ignore_sticks(ignored: bool) -> None:
        await (
            _announce_radio_calibration(conversation.vehicle)
            if ignored
            else _cancel_radio(conversation.vehicle)
        )

    await calibrate_radio(conversation, ignore_sticks)


async def _announce_radio_calibration(vehicle: Vehicle) -> None:
    """Announce a radio calibration, so that the firmware ignores the sticks; it answers UNSUPPORTED."""
    with suppress(CommandDenied):
        await vehicle.component.command(_CMD.PREFLIGHT_CALIBRATION, *_ARGUMENTS[CalibrationKind.RADIO])


async def _cancel_radio(vehicle: Vehicle) -> None:
    with suppress(CommandDenied):
        await vehicle.component.command(_CMD.PREFLIGHT_CALIBRATION)


async def _cancel_compass(vehicle: Vehicle) -> None:
    await vehicle.component.command(_CMD.DO_CANCEL_MAG_CAL)


async def _cancel_compass_motor(vehicle: Vehicle) -> None:
    """Send a COMMAND_ACK: any of them ends the calibration, and stops the motors."""
    vehicle.component.send(common.CommandAck(result=common.MavResult.ACCEPTED))


async def _cancel_esc(vehicle: Vehicle) -> None:
    await vehicle.params.set(_ESC_PARAMETER, 0)


async def _cancel_nothing(vehicle: Vehicle) -> None:
    """Leave a calibration that ends by itself, or cannot be cancelled."""
    del vehicle


#: The procedure of each kind of calibration.
PROCEDURES: Final[Mapping[CalibrationKind, Procedure]] = MappingProxyType(
    {
        CalibrationKind.ACCELEROMETER: Procedure(
            _accelerometer, _cancel_nothing, needs_confirmation=True, can_cancel=False
        ),
        CalibrationKind.GYROSCOPE: Procedure(_simple, _cancel_nothing, can_cancel=False),
        CalibrationKind.COMPASS: Procedure(_compass, _cancel_compass),
        CalibrationKind.LEVEL: Procedure(_simple, _cancel_nothing, can_cancel=False),
        CalibrationKind.AIRSPEED: Procedure(_airspeed, _cancel_nothing, can_cancel=False),
        CalibrationKind.BAROMETER: Procedure(_simple, _cancel_nothing, can_cancel=False),
        CalibrationKind.RADIO: Procedure(_radio, _cancel_radio, needs_confirmation=True),
        CalibrationKind.ESC: Procedure(_esc, _cancel_esc),
        CalibrationKind.COMPASS_MOTOR: Procedure(
            _compass_motor, _cancel_compass_motor, needs_confirmation=True
        ),
    }
)


def lacking(vehicle_type: VehicleType) -> frozenset[CalibrationKind]:
    """Return the kinds that a vehicle type lacks."""
    match vehicle_type:
        case VehicleType.COPTER:
            return frozenset({CalibrationKind.AIRSPEED})
        case VehicleType.PLANE | VehicleType.VTOL:
            return frozenset({CalibrationKind.ESC, CalibrationKind.COMPASS_MOTOR})
        case _:
            return frozenset({CalibrationKind.AIRSPEED, CalibrationKind.ESC, CalibrationKind.COMPASS_MOTOR})
