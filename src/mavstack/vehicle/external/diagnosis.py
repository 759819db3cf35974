"""The reasons why an estimator does not use external estimates: rate, delay, parameters, its own status.

Sources: ArduPilot, AP_VisualOdom and AP_NavEKF3 (estimates count for 0.3 s); PX4, EKF2 (estimates must come
every 0.2 s, and are dropped if they are older than EKF2_DELAY_MAX).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_FLAGS = common.EstimatorStatusFlags
_EXTERNAL_NAV: Final = 6
_ENOUGH: Final = 0.95
#: The lowest rate of estimates that each firmware uses, in hertz.
MIN_RATES: Final[Mapping[int, float]] = MappingProxyType(
    {common.MavAutopilot.ARDUPILOTMEGA: 1 / 0.3, common.MavAutopilot.PX4: 5.0}
)
_SOURCES: Final = MappingProxyType({0: "none", 1: "barometer or compass", 3: "GPS", 4: "beacon", 5: "flow"})
#: The ArduPilot parameters that select the source of each part of the estimate.
_ARDUPILOT_PARTS: Final = (
    ("position", "EK3_SRC1_POSXY"), ("velocity", "EK3_SRC1_VELXY"), ("yaw", "EK3_SRC1_YAW"),
)  # fmt: skip
#: The bits of EKF2_EV_CTRL for each part.
_PX4_PARTS: Final = (("position", 3, "3"), ("velocity", 4, "4"), ("yaw", 8, "8"))
#: The parameters that the diagnosis reads.
PARAMETERS: Final[Mapping[int, tuple[str, ...]]] = MappingProxyType(
    {
        common.MavAutopilot.ARDUPILOTMEGA: (
            "VISO_TYPE", "AHRS_EKF_TYPE", *(name for _, name in _ARDUPILOT_PARTS),
        ),
        common.MavAutopilot.PX4: ("EKF2_EV_CTRL", "EKF2_DELAY_MAX", "EKF2_EV_QMIN"),
    }
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class ExternalStatus:
    """The use of the estimates of this program by the estimator of a vehicle.

    Attributes:
        sent: The estimates that were sent.
        rate: Estimates per second.
        delay: Seconds from the measurement to the arrival at the vehicle: the age at sending, and half of
            the round trip of the link if TIMESYNC has measured it; None before the first estimate.
        clock_offset: Seconds by which the clock of the vehicle is ahead (TIMESYNC); None: not known.
        reasons: Why the estimator does not use them; empty if it does.
    """

    sent: int
    rate: float
    delay: float | None
    clock_offset: float | None
    reasons: tuple[str, ...]

    @property
    def is_used(self) -> bool:
        """True if nothing speaks against the use."""
        return not self.reasons

    def __str__(self) -> str:
        if self.reasons:
            return f"the estimator does not use it: {'; '.join(self.reasons)}"
        return "the estimator uses it"


@dataclass(frozen=True, slots=True)
class EstimatorFacts:
    """The facts of a diagnosis.

    Attributes:
        autopilot: The MAV_AUTOPILOT.
        parts: The parts that are sent: "position", "yaw", "velocity".
        rate: Estimates per second; None: another program sends them.
        delay: Seconds; None: not known.
        quality: The quality of the last estimate in percent.
        parameters: The values of `PARAMETERS`; those that the vehicle lacks are missing.
        status: ESTIMATOR_STATUS or EKF_STATUS_REPORT; None if none was received.
    """

    autopilot: int
    parts: frozenset[str]
    rate: float | None
    delay: float | None = None
    quality: int = 0
    parameters: Mapping[str, float] = field(default_factory=dict)
    status: common.EstimatorStatus | ardupilotmega.EkfStatusReport | None = None


def find_reasons(facts: EstimatorFacts) -> tuple[str, ...]:
    """Return why an estimator does not use external estimates; empty if it does."""
    found = [*_stream(facts)]
    if facts.autopilot == common.MavAutopilot.PX4:
        found += _px4(facts)
    elif facts.autopilot == common.MavAutopilot.ARDUPILOTMEGA:
        found += _ardupilot(facts)
    return (*found, *_status(facts))


def _stream(facts: EstimatorFacts) -> Iterator[str]:
    if not facts.parts:
        yield "nothing was sent"
        return
    lowest = MIN_RATES.get(facts.autopilot, 4.0)
    if facts.rate is not None and facts.rate < lowest * _ENOUGH:
        yield f"it comes at {facts.rate:.1f} Hz, and the firmware needs {lowest:.1f} Hz (30 Hz is usual)"


def _ardupilot(facts: EstimatorFacts) -> Iterator[str]:
    known = facts.parameters
    if "VISO_TYPE" not in known:
        yield "VISO_TYPE was not found: the firmware may have been built without visual odometry"
    elif known["VISO_TYPE"] == 0:
        yield "VISO_TYPE is 0: set it to 1 (MAVLink), and reboot"
    if known.get("AHRS_EKF_TYPE", 3) not in (3, 11):
        yield f"AHRS_EKF_TYPE is {known['AHRS_EKF_TYPE']:g}: set it to 3 (EKF3)"
    for part, name in _ARDUPILOT_PARTS:
        source = known.get(name)
        # ArduPilot can use external positions without external velocities, and with headings of its compass:
        # only the source of the position must be external.
        if part == "position" and part in facts.parts and source is not None and source != _EXTERNAL_NAV:
            word = _SOURCES.get(int(source), "another source")
            yield f"{name} is {source:g} ({word}): set it to {_EXTERNAL_NAV} (ExternalNav)"


def _px4(facts: EstimatorFacts) -> Iterator[str]:
    known = facts.parameters
    control = int(known.get("EKF2_EV_CTRL", 0))
    if not control:
        yield "EKF2_EV_CTRL is 0: set bits for position (3), velocity (4) and yaw (8)"
    elif not any(control & bits for part, bits, _ in _PX4_PARTS if part in facts.parts):
        wanted = " or ".join(text for part, _, text in _PX4_PARTS if part in facts.parts)
        yield f"EKF2_EV_CTRL is {control}, without the bits of what is sent ({wanted})"
    limit = known.get("EKF2_DELAY_MAX", 200.0) / 1000
    if facts.delay is not None and facts.delay > limit:
        yield f"it is {facts.delay * 1000:.0f} ms old, and EKF2_DELAY_MAX is {limit * 1000:.0f} ms"
    lowest = known.get("EKF2_EV_QMIN", 0)
    if facts.rate is not None and 0 < lowest > facts.quality:
        yield f"its quality is {facts.quality}, and EKF2_EV_QMIN is {lowest:g}"


def _status(facts: EstimatorFacts) -> Iterator[str]:
    status = facts.status
    if status is None:
        yield "the vehicle sends neither ESTIMATOR_STATUS nor EKF_STATUS_REPORT"
        return
    name = "ESTIMATOR_STATUS" if isinstance(status, common.EstimatorStatus) else "EKF_STATUS_REPORT"
    if "position" in facts.parts:
        if not status.flags & (_FLAGS.POS_HORIZ_REL | _FLAGS.POS_HORIZ_ABS):
            yield f"{name} has no horizontal position"
        elif not status.flags & _FLAGS.POS_HORIZ_ABS:
            yield "the estimator has no origin: vehicle.external.set_origin"
    for value, word in _ratios(status):
        if value > 1:
            yield f"{name} rejects the {word}: test ratio {value:.1f}"


def _ratios(status: common.EstimatorStatus | ardupilotmega.EkfStatusReport) -> tuple[tuple[float, str], ...]:
    if isinstance(status, common.EstimatorStatus):
        return (status.pos_horiz_ratio, "position"), (status.vel_ratio, "velocity"), (status.mag_ratio, "yaw")
    return (
        (status.pos_horiz_variance, "position"),
        (status.velocity_variance, "velocity"),
        (status.compass_variance, "yaw"),
    )
