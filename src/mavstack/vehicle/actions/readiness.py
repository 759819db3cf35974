"""The wait until a vehicle is ready to arm.

The messages that report its health are requested, and the vehicle is told to run its checks again and again,
so that it reports the failed ones at once.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import HealthTimeout, MavstackError, RemoteCancelled

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.vehicle.health import Health
    from mavstack.vehicle.vehicle_state import VehicleState

#: The interval at which the vehicle is told to run its checks, in seconds.
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
_OPERATION = "waiting for the readiness of"


async def wait_until_ready(vehicle: VehicleState, timeout: float | None) -> Health:
    """Wait until a vehicle is ready to arm; see `Vehicle.wait_until_ready`."""
    if (health := vehicle.health).ready:
        return health
    requests = asyncio.get_running_loop().create_task(_request_reports(vehicle))
    try:
        async with asyncio.timeout(timeout):
            while not (health := vehicle.health).ready:
                await asyncio.sleep(_READ_INTERVAL)
                if not vehicle.connection.is_open:
                    answer = "the connection was closed"
                    raise RemoteCancelled(_OPERATION, str(vehicle.address), answer=answer)
            return health
    except TimeoutError:
        answer = f"not in {timeout:g} s: {vehicle.health}"
        raise HealthTimeout(_OPERATION, str(vehicle.address), answer=answer) from None
    finally:
        requests.cancel()
        await asyncio.gather(requests, return_exceptions=True)


async def _request_reports(vehicle: VehicleState) -> None:
    telemetry = vehicle.telemetry
    async with asyncio.TaskGroup() as group:
        group.create_task(_run_checks(vehicle))
        for message, rate in (*_HEALTH_RATES, (telemetry.firmware.ESTIMATOR_MESSAGE, _ESTIMATOR_RATE)):
            group.create_task(telemetry.ensure(message, rate))
        group.create_task(telemetry.request_home())


async def _run_checks(vehicle: VehicleState) -> None:
    while True:
        with suppress(MavstackError):
            await vehicle.component.command(common.MavCmd.RUN_PREARM_CHECKS)
        await asyncio.sleep(_CHECKS_INTERVAL)
