"""The wait until a vehicle is ready to arm.

ArduPilot's pre-arm bit speaks of the present mode, such as STABILIZE, which needs no position; it would
refuse arming in GUIDED. So the estimate of the position counts too, unless the mode to be flown needs none.
ArduPilot before 4.1 reports no such bit and does not run its checks on request: it sends the failed ones as
status texts twice per minute. Such a vehicle is ready when it has reported no problem for a while.
PX4's bit speaks of the present mode as well: after a reboot without radio control that may be one that needs
sticks. Then the disarmed vehicle is put into its hold mode, in which it can be armed. A vehicle that stayed
in RTL, LAND or AUTO after its landing is put into the mode in which it waits on the ground, as by arming. If
the vehicle does not get ready, its mode is restored.

The messages that report its health are requested, and the vehicle is commanded to run its checks repeatedly,
so that it reports the failed ones immediately.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import HealthTimeout, MavstackError, RemoteCancelled
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.services.arguments import check_timeout
from mavstack.vehicle.actions.arming import enter_waiting_mode
from mavstack.vehicle.actions.conditions import SustainedCondition
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.firmware.changes import Changes, undone_on_failure
from mavstack.vehicle.telemetry.problems import recent
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.vehicle.health import Health
    from mavstack.vehicle.vehicle import Vehicle

#: The interval at which the vehicle is commanded to run its checks, in seconds.
_CHECKS_INTERVAL = 10.0
#: The interval at which its health is read, in seconds.
_READ_INTERVAL = 0.25
#: The messages that report the health, and their rates in hertz.
_HEALTH_RATES: Final[tuple[tuple[type[Message], float], ...]] = (
    (common.SysStatus, 2.0),
    (common.GpsRawInt, 1.0),
    (common.BatteryStatus, 0.5),
)
_ESTIMATOR_RATE = 1.0
#: The time in which an estimator must report, in seconds; without a report the pre-arm bit counts.
_ESTIMATOR_TIMEOUT = 4.0
#: The same for a vehicle without that bit: ArduRover 4.1 that booted on a busy machine sent its first report
#: after five seconds; one that is armed before refuses every mode that needs a position.
_ESTIMATOR_BOOT_TIME = 12.0
#: The time in which a radio control receiver must appear, in seconds.
_RADIO_TIMEOUT = 5.0
_EKF: Final = ardupilotmega.EkfStatusFlags
#: ArduPilot needs one of these positions; before arming it accepts a predicted one.
_POSITION: Final = _EKF.POS_HORIZ_ABS | _EKF.POS_HORIZ_REL | _EKF.PRED_POS_HORIZ_ABS | _EKF.PRED_POS_HORIZ_REL
#: The messages whose problems prevent arming, for a vehicle that does not report its checks.
_DECISIVE: Final = frozenset({"STATUSTEXT", "HEARTBEAT", "GPS_RAW_INT"})
#: Further messages whose problems prevent arming, unless the mode needs no position.
_DECISIVE_FOR_POSITION: Final = frozenset({"EKF_STATUS_REPORT", "ESTIMATOR_STATUS"})
#: The time without such a problem after which such a vehicle counts as ready, in seconds.
_TROUBLE_FREE_TIME: Final = 3.0
_RADIO: Final = common.MavSysStatusSensor.SENSOR_RC_RECEIVER
_OPERATION = "waiting for the readiness of"


async def wait_until_ready(
    vehicle: Vehicle,
    *,
    mode: str | None = None,
    keep_mode: bool = False,
    timeout: float | None = DEFAULT_WAIT_TIMEOUT,
) -> Health:
    """Wait until the vehicle will accept arming.

    A disarmed vehicle leaves a mode in which its firmware does not arm, such as the one that it landed
    in, as `arm` does. A disarmed PX4 vehicle without radio control leaves a mode that needs sticks for
    its hold mode.
    A vehicle that does not report its checks, such as ArduPilot before 4.1, is ready when it has a
    position and has reported no problem for some seconds.

    Args:
        mode: The name of the mode to be flown, such as "ALT_HOLD"; None: one that needs a position, as
            takeoff and all other actions do; a submarine needs one only if its GPS has a fix, or for a mode
            that is named here.
        keep_mode: Change no mode; then a vehicle in such a mode does not get ready.
        timeout: Seconds to wait; None waits for ever.

    Returns:
        The health of the ready vehicle; its `ready` is None if the vehicle does not report its checks.

    Raises:
        HealthTimeout: The vehicle was not ready in time; the text holds its problems.
        RemoteCancelled: The connection was closed.
    """
    if (health := vehicle.health).ready and (not _needs_position(vehicle, mode) or _is_estimated(vehicle)):
        return health
    check_timeout(timeout)
    readiness = _Readiness(vehicle, mode)
    changes = Changes(vehicle)
    async with undone_on_failure(changes):
        reports = _request_reports(vehicle, None if keep_mode else changes)
        requests = asyncio.get_running_loop().create_task(reports)
        try:
            return await _health_when(vehicle, readiness, timeout)
        finally:
            requests.cancel()
            await asyncio.gather(requests, return_exceptions=True)


async def _health_when(vehicle: Vehicle, readiness: _Readiness, timeout: float | None) -> Health:
    """Return the health once the vehicle is ready."""
    try:
        async with asyncio.timeout(timeout):
            while not readiness.reached():
                await asyncio.sleep(_READ_INTERVAL)
                if not vehicle.connection.is_open:
                    answer = "the connection was closed"
                    raise RemoteCancelled(_OPERATION, str(vehicle.address), answer=answer)
            return vehicle.health
    except TimeoutError:
        answer = f"not in {timeout:g} s: {_unready_text(vehicle.health)}"
        raise HealthTimeout(_OPERATION, str(vehicle.address), answer=answer) from None


def _unready_text(health: Health) -> str:
    """Return why a vehicle is not ready to fly; one that can be armed lacks a position."""
    if not health.ready:
        return str(health)
    warnings = "; ".join(map(str, health.warnings)) or "its position is not known"
    return f"it can be armed in mode {health.mode}, but not fly by position: {warnings}"


class _Readiness:
    """Tells when a vehicle will accept arming, from all that it reports."""

    def __init__(self, vehicle: Vehicle, mode: str | None) -> None:
        self._vehicle, self._mode = vehicle, mode
        self._began = vehicle.connection.now()
        self._decisive = _DECISIVE
        if mode is None or _needs_position(vehicle, mode):
            self._decisive |= _DECISIVE_FOR_POSITION
        self._trouble_free = SustainedCondition(vehicle, _TROUBLE_FREE_TIME)

    def reached(self) -> bool:
        """Return whether the vehicle is ready to arm."""
        health = self._vehicle.health
        trouble_free = self._trouble_free.update(self._is_trouble_free(health))
        timeout = _ESTIMATOR_TIMEOUT if health.ready else _ESTIMATOR_BOOT_TIME
        return bool(health.ready or trouble_free) and self._position_known(timeout)

    def _is_trouble_free(self, health: Health) -> bool:
        """Return whether a vehicle that does not report its checks reports no decisive problem."""
        reports = recent(self._vehicle.telemetry, common.SysStatus) is not None
        troubled = any(problem.source in self._decisive for problem in health.problems)
        return reports and self._vehicle.alive and health.ready is None and not troubled

    def _position_known(self, timeout: float) -> bool:
        estimated = _is_estimated(self._vehicle) if _needs_position(self._vehicle, self._mode) else True
        late = self._vehicle.connection.now() >= self._began + timeout
        return late if estimated is None else estimated


def _needs_position(vehicle: Vehicle, mode: str | None) -> bool:
    """Return whether a vehicle is ready only with a position.

    A submarine without a named mode may have no position at all; with a fix of its GPS it soon has one, and
    until then a real ArduSub refuses GUIDED without a word.
    """
    if mode is not None or vehicle.vehicle_type is not VehicleType.SUB:
        return firmware_of(vehicle).needs_position(mode)
    gps = recent(vehicle.telemetry, common.GpsRawInt)
    return gps is not None and gps.fix_type >= common.GpsFixType._3D_FIX  # noqa: SLF001 (a member of the enum)


def _is_estimated(vehicle: Vehicle) -> bool | None:
    """Return whether the horizontal position is estimated, or will be once armed; None if not reported."""
    status = recent(vehicle.telemetry, ardupilotmega.EkfStatusReport)
    return None if status is None else bool(status.flags & _POSITION)


def _lacks_radio(vehicle: Vehicle) -> bool:
    """Return whether a vehicle reports that its radio control receiver does not work."""
    status = recent(vehicle.telemetry, common.SysStatus)
    if status is None:
        return False
    wrong = status.onboard_control_sensors_enabled & ~status.onboard_control_sensors_health
    return bool(wrong & _RADIO)


async def _leave_mode(vehicle: Vehicle, changes: Changes) -> None:
    """Let a disarmed vehicle leave a mode in which its firmware does not arm.

    Without radio control that may be one that needs sticks, which takes a while to know.
    """
    while True:
        firmware = firmware_of(vehicle, changes)
        with suppress(MavstackError):
            if vehicle.armed is False and not firmware.allows_arming(vehicle.mode):
                await enter_waiting_mode(vehicle, changes)
        await asyncio.sleep(_RADIO_TIMEOUT)
        if vehicle.health.ready is False and vehicle.armed is False and _lacks_radio(vehicle):
            with suppress(MavstackError):
                await firmware_of(vehicle, changes).leave_stick_mode()


async def _request_reports(vehicle: Vehicle, changes: Changes | None) -> None:
    telemetry = vehicle.telemetry
    async with asyncio.TaskGroup() as group:
        group.create_task(_run_checks(vehicle))
        if changes is not None:
            group.create_task(_leave_mode(vehicle, changes))
        for message, rate in (*_HEALTH_RATES, (telemetry.firmware.ESTIMATOR_MESSAGE, _ESTIMATOR_RATE)):
            group.create_task(telemetry.ensure(message, rate))
        group.create_task(telemetry.request_home())


async def _run_checks(vehicle: Vehicle) -> None:
    while True:
        with suppress(MavstackError):
            await vehicle.component.command(common.MavCmd.RUN_PREARM_CHECKS)
        await asyncio.sleep(_CHECKS_INTERVAL)
