"""Whether a vehicle is ready to arm, and why not.

Ready is what the vehicle itself says: the pre-arm bit of SYS_STATUS. The reasons are all that was heard of
what is wrong with it (`telemetry.problems`). Waiting for it asks for the messages that tell it, and has the
vehicle run its checks again and again, so that it says its reasons at once.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Message, ardupilotmega, common
from mavstack.errors import HealthTimeout, MavstackError, RemoteCancelled
from mavstack.vehicle.telemetry.problems import Problem, fresh, problems_of

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry import Telemetry
    from mavstack.vehicle.vehicle import Vehicle

__all__ = ["Health", "Problem", "health_of", "wait_until_ready"]

_PREARM: Final = common.MavSysStatusSensor.PREARM_CHECK
#: How often the checks are run, in seconds.
_RUN_AGAIN = 10.0
#: How often to look, in seconds.
_LOOK = 0.25
#: What health is told by, and how often it has to come, in hertz.
_TOLD_BY: Final[tuple[tuple[type[Message], float], ...]] = (
    (common.SysStatus, 2.0),
    (common.GpsRawInt, 1.0),
    (common.BatteryStatus, 0.5),
)
_UNSAID: Final = Problem("its checks before arming fail, and it has not said which", "SYS_STATUS")


@dataclass(frozen=True, slots=True)
class Health:
    """Whether a vehicle says that it is ready to arm (None: it does not say), and what is wrong with it."""

    ready: bool | None
    problems: tuple[Problem, ...] = ()

    def __str__(self) -> str:
        said = "it does not say whether it is ready" if self.ready is None else "not ready"
        return "; ".join(("ready" if self.ready else said, *map(str, self.problems)))


def health_of(heard: Telemetry) -> Health:
    """What was heard of it, put together."""
    ready = _ready(heard)
    problems = problems_of(heard, ready=ready)
    return Health(ready, problems or ((_UNSAID,) if ready is False else ()))


async def wait_until_ready(vehicle: Vehicle, timeout: float) -> Health:
    """Wait until it is ready to arm; raises `HealthTimeout` with the reasons."""
    heard = vehicle.telemetry
    if (health := health_of(heard)).ready:
        return health
    checkup = asyncio.get_running_loop().create_task(_check_up(vehicle))
    try:
        async with asyncio.timeout(timeout):
            while not (health := health_of(heard)).ready:
                await asyncio.sleep(_LOOK)
                if not vehicle.connection.is_open:
                    whom, answer = str(vehicle.address), "the connection was closed"
                    raise RemoteCancelled("being ready to arm", whom, answer=answer)
            return health
    except TimeoutError:
        answer = f"not in {timeout:g} s: {health_of(heard)}"
        raise HealthTimeout("being ready to arm", str(vehicle.address), answer=answer) from None
    finally:
        checkup.cancel()
        await asyncio.gather(checkup, return_exceptions=True)


async def _check_up(vehicle: Vehicle) -> None:
    """See to it that what health is told by comes, and that the vehicle says its reasons."""
    heard = vehicle.telemetry
    ardupilot = heard.autopilot == common.MavAutopilot.ARDUPILOTMEGA
    estimate = ardupilotmega.EkfStatusReport if ardupilot else common.EstimatorStatus
    async with asyncio.TaskGroup() as group:
        group.create_task(_run_checks(vehicle))
        for kind, rate in (*_TOLD_BY, (estimate, 1.0)):
            group.create_task(heard.ensure(kind, rate))
        group.create_task(heard.ask_for_home())


async def _run_checks(vehicle: Vehicle) -> None:
    while True:
        with suppress(MavstackError):
            await vehicle.component.command(common.MavCmd.RUN_PREARM_CHECKS)
        await asyncio.sleep(_RUN_AGAIN)


def _ready(heard: Telemetry) -> bool | None:
    info, status = heard.component.info, fresh(heard, common.SysStatus)
    if info is None or not info.alive or status is None:
        return None
    if status.onboard_control_sensors_health & _PREARM:
        return True
    told = status.onboard_control_sensors_present | status.onboard_control_sensors_enabled
    # PX4 never calls the check present; its health bit counts all the same.
    return False if told & _PREARM or info.autopilot == common.MavAutopilot.PX4 else None
