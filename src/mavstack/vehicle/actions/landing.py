"""Landing, and returning to home: requested as the firmware wants it, and monitored.

A landing is complete when the vehicle is on the ground and disarmed, or on the ground for a while. A return
is complete after the landing at home; a vehicle that does not land there has returned when it has arrived
(see `arrival`). It need not report where home is.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.errors import RemoteError
from mavstack.vehicle.action_monitor import STALL_TIMEOUT, ActionGoal
from mavstack.vehicle.actions.arrival import Arrival, check_tolerance, tolerance_if_waiting
from mavstack.vehicle.actions.conditions import LandingDetector, SustainedCondition
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.actions.quadplane import detect_quadplane
from mavstack.vehicle.actions.running import relative_altitude_of, remaining_timeout, run_action
from mavstack.vehicle.firmware import Firmware, firmware_of
from mavstack.vehicle.vehicle_type import VehicleType, flies_on_wing

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle

#: A vehicle that circles home for this time in seconds will not land: some quadplanes stay there.
CIRCLING_TIME: Final = 30.0
#: The time for which the remaining distance of a return need not decrease, in seconds.
_RETURN_STALL_TIMEOUT: Final = 90.0
#: The same time for a vehicle on a wing that keeps its altitude in a landing pattern, and for an unknown
#: home.
_PATTERN_STALL_TIMEOUT: Final = 600.0


async def land(vehicle: Vehicle, *, wait: bool = True, timeout: float | None = None) -> None:
    """Land at the present position; an ArduPilot plane lands where its mission tells it to.

    Args:
        wait: Wait until the vehicle has landed.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        ActionRefused: The vehicle is not armed; nothing was sent.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    check_preconditions(vehicle, "land", "landing")
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    plane = vehicle.vehicle_type is VehicleType.PLANE
    goal = ActionGoal(
        LandingDetector(vehicle).has_landed,
        lambda: relative_altitude_of(vehicle),
        modes=firmware.modes_of("land"),
        stall_timeout=_PATTERN_STALL_TIMEOUT if plane else STALL_TIMEOUT,
    )
    await run_action(
        vehicle,
        "landing",
        firmware.land(),
        lambda: goal,
        changes=firmware.changes,
        wait=wait,
        timeout=timeout,
    )


async def rtl(
    vehicle: Vehicle, *, tolerance: float | None = None, wait: bool = True, timeout: float | None = None
) -> None:
    """Return to home, and land there if the vehicle does that.

    A plane has returned when it circles home and does not climb or sink any more.

    Args:
        tolerance: Metres from home at which a vehicle that does not land has arrived; None: see `goto`.
        wait: Wait until the vehicle has landed, or has arrived where it does not land.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        ActionRefused: The vehicle is not armed; nothing was sent.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    check_tolerance(tolerance)
    operation = "return to launch of"
    check_preconditions(vehicle, "rtl", operation)
    started = vehicle.connection.now()
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    landing = LandingDetector(vehicle)
    kind = vehicle.vehicle_type
    limits = await tolerance_if_waiting(vehicle, tolerance, wait, timeout)
    arrival = Arrival(vehicle, lambda: _home_of(vehicle), None, limits, tolerance)
    timeout = remaining_timeout(vehicle, timeout, started)

    def remaining() -> float | None:
        away = arrival.remaining()
        height = relative_altitude_of(vehicle) if kind.flies else 0.0
        return None if away is None or height is None else away + abs(height)

    circling = SustainedCondition(vehicle, CIRCLING_TIME)

    def reached() -> bool:
        if not kind.flies:
            return arrival.reached()
        arrived = arrival.reached() and flies_on_wing(vehicle.vehicle_type, vehicle.vtol_state)
        landed = landing.has_landed()
        return landed or (arrived and kind is VehicleType.PLANE) or circling.update(arrived)

    def goal() -> ActionGoal:
        stall_timeout = _PATTERN_STALL_TIMEOUT if vehicle.home is None else _RETURN_STALL_TIMEOUT
        return ActionGoal(
            reached,
            remaining,
            modes=firmware.modes_of("rtl"),
            stall_timeout=stall_timeout,
            signs=arrival.signs,
            detail=arrival.detail,
        )

    request = _request_return(vehicle, firmware, wait=wait)
    await run_action(vehicle, operation, request, goal, changes=firmware.changes, wait=wait, timeout=timeout)


async def _request_return(vehicle: Vehicle, firmware: Firmware, *, wait: bool) -> None:
    await firmware.rtl()
    if wait:
        with suppress(RemoteError):
            await vehicle.get_home()


def _home_of(vehicle: Vehicle) -> tuple[float, float] | None:
    home = vehicle.home
    return None if home is None else (home.latitude, home.longitude)
