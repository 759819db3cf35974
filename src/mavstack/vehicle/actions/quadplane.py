"""Detection of quadplanes: ArduPilot's call themselves planes (FIXED_WING) unless Q_MAV_TYPE says otherwise.

EXTENDED_SYS_STATE has the VTOL state, but ArduPilot sends it on request only. Actions that differ between
planes and quadplanes therefore request it first. It is then sent once per second, because the VTOL state also
tells whether a quadplane hovers. ArduPlane 4.0 and 4.1 leave the VTOL state undefined: there the parameter
Q_ENABLE tells a quadplane.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.vehicle.vehicle_type import QUADPLANE_PARAMETER, VehicleType

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle

#: The rate of EXTENDED_SYS_STATE, in hertz.
_RATE: Final = 1.0
#: The longest time that an action waits for the VTOL state, in seconds.
_DETECTION_TIMEOUT: Final = 3.0


async def detect_quadplane(vehicle: Vehicle) -> None:
    """Request the VTOL state of an ArduPilot plane, so that `vehicle_type` is VTOL if it is a quadplane."""
    telemetry = vehicle.telemetry
    if (
        vehicle.autopilot != common.MavAutopilot.ARDUPILOTMEGA
        or vehicle.vehicle_type is not VehicleType.PLANE
    ):
        return
    with suppress(MavstackError, TimeoutError):
        async with asyncio.timeout(_DETECTION_TIMEOUT):
            if telemetry.latest(common.ExtendedSysState) is None and await telemetry.ensure(
                common.ExtendedSysState, _RATE
            ):
                await vehicle.component.request_message(common.ExtendedSysState)
    if vehicle.vtol_state is None and QUADPLANE_PARAMETER not in vehicle.params.cached:
        with suppress(MavstackError):
            await vehicle.params.get(QUADPLANE_PARAMETER, timeout=_DETECTION_TIMEOUT)
