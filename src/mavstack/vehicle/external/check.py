"""The check whether an estimator uses external estimates: a method of `External`."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import RemoteError
from mavstack.vehicle.external.diagnosis import PARAMETERS, EstimatorFacts, ExternalStatus, find_reasons

if TYPE_CHECKING:
    from mavstack.vehicle.external.external import External
    from mavstack.vehicle.vehicle import Vehicle

#: Timeout of one parameter in seconds; a vehicle that lacks the parameter does not answer.
_PARAMETER_TIMEOUT: Final = 3.0
_STATUS_AGE: Final = 3.0


async def check(
    external: External, *, parts: frozenset[str] = frozenset(), timeout: float | None = None
) -> ExternalStatus:
    """Find out whether the estimator uses the estimates of this program, and why not.

    Parameters are requested, and the status of the estimator if none was received lately.

    Args:
        parts: The parts that another program sends, of "position", "yaw" and "velocity": then only the
            settings and the status of the vehicle count. Empty: the estimates of this program.
        timeout: Seconds for each request; None: a few seconds.

    Returns:
        The status: rate, delay, and the reasons.

    Raises:
        RemoteCancelled: The connection was closed.
    """
    vehicle = external.vehicle
    now = vehicle.component.now()
    offset = vehicle.component.clock.estimate
    delay = external.monitor.delay(now)
    if delay is not None and offset is not None:
        delay += offset.round_trip / 2
    rate = external.monitor.rate(now)
    facts = EstimatorFacts(
        vehicle.autopilot,
        parts or external.monitor.parts,
        None if parts else rate,
        delay,
        external.monitor.quality,
        await _parameters(external.vehicle, timeout or _PARAMETER_TIMEOUT),
        await _estimator_status(external.vehicle, timeout or _PARAMETER_TIMEOUT),
    )
    clock = None if offset is None else offset.offset
    return ExternalStatus(external.monitor.sent, rate, delay, clock, find_reasons(facts))


async def _parameters(vehicle: Vehicle, timeout: float) -> dict[str, float]:
    found: dict[str, float] = {}
    for name in PARAMETERS.get(vehicle.autopilot, ()):
        with suppress(RemoteError):  # the vehicle does not have the parameter
            found[name] = float((await vehicle.params.get(name, timeout=timeout)).value)
    return found


async def _estimator_status(
    vehicle: Vehicle, timeout: float
) -> common.EstimatorStatus | ardupilotmega.EkfStatusReport | None:
    telemetry = vehicle.telemetry
    kind: type[common.EstimatorStatus | ardupilotmega.EkfStatusReport] = common.EstimatorStatus
    if vehicle.autopilot == common.MavAutopilot.ARDUPILOTMEGA:
        kind = ardupilotmega.EkfStatusReport
    age = telemetry.age(kind)
    if age is not None and age <= _STATUS_AGE:
        return telemetry.latest(kind)
    try:
        return await vehicle.component.request_message(kind, timeout=timeout)
    except RemoteError:
        return None
