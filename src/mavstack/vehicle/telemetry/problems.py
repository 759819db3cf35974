"""What is wrong with a vehicle, as far as it was heard: in words, its own first, and which message told it.

ArduPilot says all reasons in one go, when asked to and every half minute; PX4 says each when it arises, and
all when asked to. A reason that was said before the vehicle was ready is no reason any more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.dialects import Message, ardupilotmega, common
from mavstack.vehicle.telemetry.problem_texts import (
    CHARGE,
    ESTIMATES,
    FAILURES,
    MORE_SENSORS,
    PREFIXES,
    RATIOS,
    SAYS_NOTHING,
    SENSORS,
    STATES,
)
from mavstack.vehicle.telemetry.readers import read_batteries, read_gps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.vehicle.telemetry.telemetry import Telemetry
    from mavstack.vehicle.telemetry.values import StatusText

AnyMessage = TypeVar("AnyMessage", bound=Message)

#: What is older was true then, in seconds; PX4 on a slow link sends SYS_STATUS every ten.
STALE = 30.0
#: ArduPilot's reasons come within this time, and again before `_REPEATED`; PX4's belong together longer.
_ONE_GO, _ONE_BY_ONE = 3.0, 60.0
_REPEATED = 40.0
#: A test ratio above this says that a sensor does not fit the rest.
_GATE = 1.0
_ARDUPILOT: Final = common.MavAutopilot.ARDUPILOTMEGA
_GPS: Final = common.MavSysStatusSensor.SENSOR_GPS
_EKF: Final = ardupilotmega.EkfStatusFlags
_ESTIMATOR: Final = common.EstimatorStatusFlags


@dataclass(frozen=True, slots=True)
class Problem:
    """Something that is wrong, in words, and the message that told it."""

    text: str
    source: str

    def __str__(self) -> str:
        return self.text


def fresh(heard: Telemetry, kind: type[AnyMessage]) -> AnyMessage | None:
    """The last message of a kind, if it is not too old to count."""
    age = heard.age(kind)
    return heard.latest(kind) if age is not None and age <= STALE else None


def problems_of(heard: Telemetry, *, ready: bool | None) -> tuple[Problem, ...]:
    """Everything that is wrong, each thing once; what it said counts unless it is ready."""
    found = [] if ready else [Problem(text, "STATUSTEXT") for text in _said(heard)]
    for source, look in _LOOKS:
        found += [Problem(text, source) for text in look(heard)]
    once: dict[str, Problem] = {}
    for problem in found:
        once.setdefault(problem.text, problem)
    return tuple(once.values())


def _said(heard: Telemetry) -> Iterator[str]:
    """The reasons in its own words."""
    since = heard.ready_at or 0.0
    texts = [text for text in heard.status_texts.since(since) if _is_reason(text, heard)]
    if not texts:
        return
    ardupilot = heard.autopilot == _ARDUPILOT
    last = texts[-1].time
    if ardupilot and last < heard.now() - _REPEATED:
        return
    begun = last - (_ONE_GO if ardupilot else _ONE_BY_ONE)
    bare = (_bare(text.text) for text in texts if text.time >= begun)
    yield from (text for text in bare if text not in SAYS_NOTHING)


def _is_reason(text: StatusText, heard: Telemetry) -> bool:
    return text.component == heard.component.address.component and text.text.startswith(PREFIXES)


def _bare(text: str) -> str:
    return text.partition(": ")[2].strip()


def _sensors(heard: Telemetry) -> Iterator[str]:
    status = fresh(heard, common.SysStatus)
    if status is None:
        return
    wrong = status.onboard_control_sensors_enabled & ~status.onboard_control_sensors_health
    more = status.onboard_control_sensors_enabled_extended & ~status.onboard_control_sensors_health_extended
    if any(_satellites(heard)):
        wrong &= ~_GPS  # said better there
    for mask, names in ((wrong, SENSORS), (more, MORE_SENSORS)):
        yield from (f"{name} is not healthy" for bit, name in names if mask & bit)


def _satellites(heard: Telemetry) -> Iterator[str]:
    gps = read_gps(heard) if fresh(heard, common.GpsRawInt) else None
    if gps is None or gps.has_fix:
        return
    if gps.fix == common.GpsFixType.NO_GPS:
        status = fresh(heard, common.SysStatus)
        if status is None or status.onboard_control_sensors_present & _GPS:
            yield "no GPS receiver is heard"
        return
    seen = "" if gps.satellites is None else f" ({gps.satellites} satellites)"
    yield f"GPS has no 3D fix{seen}"


def _ekf(heard: Telemetry) -> Iterator[str]:
    status = fresh(heard, ardupilotmega.EkfStatusReport)
    if status is None:
        return
    if status.flags & _EKF.UNINITIALIZED:
        yield "the estimator is not initialised"
        return
    if status.flags & _EKF.GPS_GLITCHING:
        yield "GPS glitches"
    yield from _missing(status.flags)
    yield from _misfits(tuple(getattr(status, name) for name, _, _ in RATIOS))


def _estimator(heard: Telemetry) -> Iterator[str]:
    status = fresh(heard, common.EstimatorStatus)
    if status is None:
        return
    if status.flags & _ESTIMATOR.GPS_GLITCH:
        yield "GPS glitches"
    if status.flags & _ESTIMATOR.ACCEL_ERROR:
        yield "the accelerometer is not believed"
    yield from _missing(status.flags)
    yield from _misfits(tuple(getattr(status, name) for _, name, _ in RATIOS))


def _missing(flags: int) -> Iterator[str]:
    yield from (f"{what} is not estimated" for bits, what in ESTIMATES if not flags & bits)


def _misfits(ratios: tuple[float, ...]) -> Iterator[str]:
    for ratio, (_, _, what) in zip(ratios, RATIOS, strict=True):
        if ratio > _GATE:
            yield f"{what} does not fit the estimate"


def _battery(heard: Telemetry) -> Iterator[str]:
    if fresh(heard, common.BatteryStatus) is None:
        return
    for number, battery in read_batteries(heard).items():
        left = "" if battery.remaining is None else f" ({battery.remaining:.0f} %)"
        yield from (f"battery {number} {how}{left}" for state, how in CHARGE if battery.charge_state == state)
        if battery.faults:
            yield f"battery {number} reports a fault"


def _home(heard: Telemetry) -> Iterator[str]:
    if heard.home_refused and heard.latest(common.HomePosition) is None:
        yield "home is not known"


def _high_latency(heard: Telemetry) -> Iterator[str]:
    info = heard.component.info
    summary = heard.latest(common.HighLatency2)
    if info is not None and info.high_latency and summary is not None:
        flags = summary.failure_flags
        yield from (f"{name} is not healthy" for bit, name in FAILURES if flags & bit)


def _heartbeat(heard: Telemetry) -> Iterator[str]:
    info = heard.component.info
    if info is None:
        yield "it was never heard"
    elif not info.alive:
        yield f"it is silent for {heard.now() - info.last_seen:.0f} s"
    elif not info.high_latency:
        yield from (what for state, what in STATES if info.system_status == state)


_LOOKS: Final[tuple[tuple[str, Callable[[Telemetry], Iterator[str]]], ...]] = (
    ("GPS_RAW_INT", _satellites),
    ("SYS_STATUS", _sensors),
    ("EKF_STATUS_REPORT", _ekf),
    ("ESTIMATOR_STATUS", _estimator),
    ("BATTERY_STATUS", _battery),
    ("HOME_POSITION", _home),
    ("HIGH_LATENCY2", _high_latency),
    ("HEARTBEAT", _heartbeat),
)
