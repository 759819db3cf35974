"""The problems that a vehicle reports: as texts, its own status texts first, with the message of each.

The firmware class tells how failed checks are reported by status texts. A check that failed before the
vehicle was ready is out of date.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.dialects import Message, ardupilotmega, common
from mavstack.vehicle.telemetry.problem_texts import (
    CHARGE_STATES,
    ESTIMATES,
    EXTENDED_SENSORS,
    FAILURES,
    RATIOS,
    SENSORS,
    STATES,
)
from mavstack.vehicle.telemetry.readers import read_batteries, read_gps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.vehicle.telemetry.telemetry import Telemetry
    from mavstack.vehicle.telemetry.values import StatusText

AnyMessage = TypeVar("AnyMessage", bound=Message)

#: The largest age of a message that counts, in seconds; PX4 on a slow link sends SYS_STATUS every ten
#: seconds.
MAX_AGE = 30.0
#: A test ratio above this means that a sensor contradicts the estimate.
_MAX_TEST_RATIO = 1.0
_GPS: Final = common.MavSysStatusSensor.SENSOR_GPS
_EKF: Final = ardupilotmega.EkfStatusFlags
_ESTIMATOR: Final = common.EstimatorStatusFlags


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem of a vehicle: its text, and the name of the message that reports it."""

    text: str
    source: str

    def __str__(self) -> str:
        return self.text


def recent(telemetry: Telemetry, message: type[AnyMessage]) -> AnyMessage | None:
    """Return the last message of a class, or None if it is too old to count.

    A message from before a reboot is too old, and one from before the vehicle became ready: then its GPS may
    have had no fix yet.
    """
    received_at = telemetry.received_at(message)
    since = max(telemetry.now() - MAX_AGE, telemetry.rebooted_at)
    if message is not common.SysStatus:
        since = max(since, telemetry.ready_since or since)
    if received_at is None or received_at < since:
        return None
    return telemetry.latest(message)


def problems_of(telemetry: Telemetry, *, ready: bool | None) -> tuple[Problem, ...]:
    """Return all problems, each once; status texts count unless the vehicle is ready."""
    found = [] if ready else [Problem(text, "STATUSTEXT") for text in _failed_checks(telemetry)]
    for source, find in _FINDERS:
        found += [Problem(text, source) for text in find(telemetry)]
    by_text: dict[str, Problem] = {}
    for problem in found:
        by_text.setdefault(problem.text, problem)
    return tuple(by_text.values())


def _failed_checks(telemetry: Telemetry) -> Iterator[str]:
    """Yield the failed checks that the vehicle reported by status texts."""
    firmware = telemetry.firmware
    since = telemetry.ready_at or 0.0
    texts = [text for text in telemetry.status_texts.since(since) if _is_failed_check(text, telemetry)]
    if not texts:
        return
    last = texts[-1].time
    if last < telemetry.now() - firmware.PREARM_LIFETIME:
        return
    begun = last - firmware.PREARM_RUN
    bare = (_without_prefix(text.text) for text in texts if text.time >= begun)
    yield from (text for text in bare if text not in firmware.PREARM_EMPTY_TEXTS)


def _is_failed_check(text: StatusText, telemetry: Telemetry) -> bool:
    return text.component == telemetry.component.address.component and text.text.startswith(
        telemetry.firmware.PREARM_PREFIXES
    )


def _without_prefix(text: str) -> str:
    return text.partition(": ")[2].strip()


def _sensors(telemetry: Telemetry) -> Iterator[str]:
    status = recent(telemetry, common.SysStatus)
    if status is None:
        return
    # Numbers, not flags: a set of flags without a name of its own is slow to make, and health is read often.
    enabled, healthy = int(status.onboard_control_sensors_enabled), int(status.onboard_control_sensors_health)
    wrong = enabled & ~healthy
    if any(_gps_problems(telemetry)):
        wrong &= ~int(_GPS)  # the GPS problem has more detail
    more = int(status.onboard_control_sensors_enabled_extended)
    more &= ~int(status.onboard_control_sensors_health_extended)
    for mask, names in ((wrong, SENSORS), (more, EXTENDED_SENSORS)):
        if mask:
            yield from (f"{name} is not healthy" for bit, name in names if mask & int(bit))


def _gps_problems(telemetry: Telemetry) -> Iterator[str]:
    gps = read_gps(telemetry) if recent(telemetry, common.GpsRawInt) else None
    if gps is None or gps.has_fix:
        return
    if gps.fix == common.GpsFixType.NO_GPS:
        status = recent(telemetry, common.SysStatus)
        if status is None or status.onboard_control_sensors_present & _GPS:
            yield "no GPS receiver is connected"
        return
    seen = "" if gps.satellites is None else f" ({gps.satellites} satellites)"
    yield f"GPS has no 3D fix{seen}"


def _ekf(telemetry: Telemetry) -> Iterator[str]:
    status = recent(telemetry, ardupilotmega.EkfStatusReport)
    if status is None:
        return
    if status.flags & _EKF.UNINITIALIZED:
        yield "the estimator is not initialised"
        return
    if status.flags & _EKF.GPS_GLITCHING:
        yield "GPS glitches"
    yield from _missing(int(status.flags))
    yield from _contradictions(tuple(getattr(status, name) for name, _, _ in RATIOS))


def _estimator(telemetry: Telemetry) -> Iterator[str]:
    status = recent(telemetry, common.EstimatorStatus)
    if status is None:
        return
    if status.flags & _ESTIMATOR.GPS_GLITCH:
        yield "GPS glitches"
    if status.flags & _ESTIMATOR.ACCEL_ERROR:
        yield "the estimator rejects the accelerometer"
    yield from _missing(int(status.flags))
    yield from _contradictions(tuple(getattr(status, name) for _, name, _ in RATIOS))


def _missing(flags: int) -> Iterator[str]:
    yield from (f"{name} is not estimated" for bits, name in ESTIMATES if not flags & int(bits))


def _contradictions(ratios: tuple[float, ...]) -> Iterator[str]:
    for ratio, (_, _, name) in zip(ratios, RATIOS, strict=True):
        if ratio > _MAX_TEST_RATIO:
            yield f"{name} contradicts the estimate"


def _battery(telemetry: Telemetry) -> Iterator[str]:
    if recent(telemetry, common.BatteryStatus) is None:
        return
    for number, battery in read_batteries(telemetry).items():
        left = "" if battery.remaining is None else f" ({battery.remaining:.0f} %)"
        yield from (
            f"battery {number} {how}{left}" for state, how in CHARGE_STATES if battery.charge_state == state
        )
        if battery.faults:
            yield f"battery {number} reports a fault"


def _home(telemetry: Telemetry) -> Iterator[str]:
    if telemetry.home_refused and telemetry.latest(common.HomePosition) is None:
        yield "home is not known"


def _high_latency(telemetry: Telemetry) -> Iterator[str]:
    info = telemetry.component.info
    summary = telemetry.latest(common.HighLatency2)
    if info is not None and info.high_latency and summary is not None:
        flags = summary.failure_flags
        yield from (f"{name} is not healthy" for bit, name in FAILURES if flags & bit)


def _heartbeat(telemetry: Telemetry) -> Iterator[str]:
    info = telemetry.component.info
    if info is None:
        yield "no heartbeat was received"
    elif not info.alive:
        yield f"it is silent for {telemetry.now() - info.last_seen:.0f} s"
    elif not info.high_latency:
        yield from (text for state, text in STATES if info.system_status == state)


_FINDERS: Final[tuple[tuple[str, Callable[[Telemetry], Iterator[str]]], ...]] = (
    ("GPS_RAW_INT", _gps_problems),
    ("SYS_STATUS", _sensors),
    ("EKF_STATUS_REPORT", _ekf),
    ("ESTIMATOR_STATUS", _estimator),
    ("BATTERY_STATUS", _battery),
    ("HOME_POSITION", _home),
    ("HIGH_LATENCY2", _high_latency),
    ("HEARTBEAT", _heartbeat),
)
