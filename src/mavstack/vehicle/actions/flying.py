"""Landing, returning, going somewhere: requested as the firmware wants it, and monitored.

Preconditions are checked before anything is sent (`preconditions`), and the steps of a request that fails are
reversed (`firmware.changes`). An action is complete when the telemetry shows it, not when the firmware
acknowledges it:

    land      on the ground and disarmed, or on the ground for a while
    rtl       the same; a vehicle that does not land there: arrived at home (see `arrival`)
    goto      arrived: settled within the tolerance; a wing: on the circle around the location
    orbit     on the circle, in its direction (see `orbiting`)
    turn      within five degrees
"""

from __future__ import annotations

from contextlib import suppress
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError, RemoteError
from mavstack.geodesy import offset_location
from mavstack.services.arguments import check_number, check_numbers
from mavstack.vehicle.action_monitor import MIN_PROGRESS, STALL_TIMEOUT, ActionGoal
from mavstack.vehicle.actions.arrival import (
    Arrival,
    Tolerance,
    check_tolerance,
    default_tolerance,
    tolerance_of,
)
from mavstack.vehicle.actions.conditions import LandingDetector, SustainedCondition
from mavstack.vehicle.actions.limits import (
    check_location,
    check_target,
    explain_far_target,
)
from mavstack.vehicle.actions.orbiting import Orbiting
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.actions.quadplane import detect_quadplane
from mavstack.vehicle.actions.running import relative_altitude_of, run_action
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.geography import Location
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.vehicle_type import VehicleType, flies_on_wing

if TYPE_CHECKING:
    from mavstack.vehicle.firmware.changes import Changes
    from mavstack.vehicle.vehicle_state import VehicleState

_HEADING_TOLERANCE: Final = 5.0
#: A vehicle that circles home for so long is not going to land, in seconds: some quadplanes do not.
CIRCLING_TIME: Final = 30.0
#: The time without progress of a wing, which turns and climbs on its way, in seconds.
_WING_STALL_TIMEOUT: Final = 60.0
#: The time in which the remaining distance of a return may not fall, in seconds.
_RETURN_STALL_TIMEOUT: Final = 90.0
#: The same for a wing that keeps its altitude in a landing pattern, and for a return to an unknown home.
_PATTERN_STALL_TIMEOUT: Final = 600.0


async def land(vehicle: VehicleState, *, wait: bool, timeout: float | None) -> None:
    """Land, and wait until the motors stand still."""
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


async def rtl(vehicle: VehicleState, *, tolerance: float | None, wait: bool, timeout: float | None) -> None:
    """Return to home, and land there if the vehicle does that; it need not report where home is."""
    check_tolerance(tolerance)
    operation = "return to launch of"
    check_preconditions(vehicle, "rtl", operation)
    started = vehicle.connection.now()
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    landing = LandingDetector(vehicle)
    kind = vehicle.vehicle_type
    limits = await _tolerance(vehicle, tolerance, wait, timeout)
    arrival = Arrival(vehicle, lambda: _home_of(vehicle), None, limits, tolerance)
    timeout = _remaining_timeout(vehicle, timeout, started)

    async def request() -> None:
        await firmware.rtl()
        if wait:
            with suppress(RemoteError):
                await vehicle.get_home()

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

    await run_action(
        vehicle, operation, request(), goal, changes=firmware.changes, wait=wait, timeout=timeout
    )


async def move(
    vehicle: VehicleState,
    offset: tuple[float, float, float],
    *,
    tolerance: float | None,
    override_limits: bool,
    wait: bool,
    timeout: float | None,
) -> None:
    """Go to the location at an offset in metres (north, east, up) from the vehicle."""
    check_tolerance(tolerance)
    north, east, up = offset
    if up and not vehicle.vehicle_type.has_altitude:
        raise firmware_of(vehicle).unsupported("move up or down")
    check_preconditions(vehicle, "goto", "moving")
    started = vehicle.connection.now()
    async with deadline(timeout, "moving", vehicle.address):
        position = await vehicle.get_position()
    altitude = None if not up else (position.relative_altitude or 0.0) + up
    location = Location(*offset_location(position.latitude, position.longitude, north, east), altitude)
    timeout = _remaining_timeout(vehicle, timeout, started)
    await goto(
        vehicle,
        location,
        yaw=None,
        radius=None,
        tolerance=tolerance,
        override_limits=override_limits,
        wait=wait,
        timeout=timeout,
    )


async def goto(
    vehicle: VehicleState,
    location: Location,
    *,
    yaw: float | None,
    radius: float | None,
    tolerance: float | None,
    override_limits: bool,
    wait: bool,
    timeout: float | None,
    changes: Changes | None = None,
) -> None:
    """Go to a location and stay there; `changes` are those of the call that this one is a part of."""
    check_numbers(yaw=yaw, radius=radius)
    check_tolerance(tolerance)
    check_location(location)
    operation = f"going to {location.latitude:.6f}, {location.longitude:.6f} with"
    check_preconditions(vehicle, "goto", operation)
    started = vehicle.connection.now()
    await check_target(vehicle, location, override_limits=override_limits, timeout=timeout)
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle, changes)
    if radius is not None:
        await firmware.check_circle(radius, orbit=False)
    limits = await _tolerance(vehicle, tolerance, wait, timeout)
    timeout = _remaining_timeout(vehicle, timeout, started)
    place = location.latitude, location.longitude
    arrival = Arrival(vehicle, lambda: place, location.altitude, limits, tolerance)
    goal = ActionGoal(
        arrival.reached,
        arrival.remaining,
        modes=firmware.modes_of("goto"),
        armed=True,
        stall_timeout=_WING_STALL_TIMEOUT if vehicle.vehicle_type.circles else STALL_TIMEOUT,
        signs=arrival.signs,
        min_progress=min(MIN_PROGRESS, limits.ground / 2),
        detail=arrival.detail,
    )
    request = firmware.goto(location, yaw=yaw, radius=radius)
    with explain_far_target(vehicle, location):
        await run_action(
            vehicle, operation, request, lambda: goal, changes=firmware.changes, wait=wait, timeout=timeout
        )


async def orbit(
    vehicle: VehicleState,
    center: Location,
    *,
    radius: float,
    speed: float | None,
    tolerance: float | None,
    override_limits: bool,
    wait: bool,
    timeout: float | None,
) -> None:
    """Circle a location."""
    check_numbers(speed=speed)
    check_tolerance(tolerance)
    check_number("radius", radius, finite=False)
    if not (isfinite(radius) and radius):
        raise InvalidArgumentError(
            f"orbit radius must be finite and not 0 (negative: counter-clockwise), got {radius}"
        )
    operation = f"orbit of {abs(radius):g} m radius with"
    check_preconditions(vehicle, "orbit", operation)
    started = vehicle.connection.now()
    await check_target(vehicle, center, override_limits=override_limits, timeout=timeout)
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    await firmware.check_circle(radius, orbit=True)
    timeout = _remaining_timeout(vehicle, timeout, started)
    orbiting = Orbiting(vehicle, center, radius, tolerance)

    async def request() -> None:
        entry = await firmware.prepare_orbit(center, radius)
        if entry is not None:
            await goto(
                vehicle, entry.location, yaw=entry.heading, radius=None, tolerance=None,
                override_limits=True, wait=True, timeout=None, changes=firmware.changes,
            )  # fmt: skip
            if entry.heading is not None:
                await turn(vehicle, entry.heading, wait=True, timeout=None, changes=firmware.changes)
        await firmware.orbit(center, radius=radius, speed=speed)

    goal = ActionGoal(
        orbiting.reached,
        orbiting.remaining,
        modes=firmware.modes_of("orbit"),
        armed=True,
        stall_timeout=_WING_STALL_TIMEOUT if vehicle.vehicle_type.circles else STALL_TIMEOUT,
        signs=orbiting.signs,
        detail=orbiting.detail,
        failure=orbiting.failure,
    )
    with explain_far_target(vehicle, center):
        await run_action(
            vehicle, operation, request(), lambda: goal, changes=firmware.changes, wait=wait, timeout=timeout
        )


async def turn(
    vehicle: VehicleState,
    heading: float,
    *,
    wait: bool,
    timeout: float | None,
    changes: Changes | None = None,
) -> None:
    """Turn to a heading in degrees; `changes` are those of the call that this one is a part of."""
    check_number("heading", heading)
    heading %= 360.0
    operation = f"turn to {heading:g} degrees of"
    check_preconditions(vehicle, "turn", operation)
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle, changes)

    def remaining() -> float | None:
        now = vehicle.heading
        return None if now is None else abs((now - heading + 180.0) % 360.0 - 180.0)

    goal = ActionGoal(
        lambda: (rest := remaining()) is not None and rest <= _HEADING_TOLERANCE,
        remaining,
        "degrees",
        modes=firmware.modes_of("turn"),
    )
    request = firmware.turn(heading)
    await run_action(
        vehicle, operation, request, lambda: goal, changes=firmware.changes, wait=wait, timeout=timeout
    )


async def hold(vehicle: VehicleState, *, timeout: float | None) -> None:
    """Stay at the present position."""
    operation = "holding the position of"
    check_preconditions(vehicle, "hold", operation)
    async with deadline(timeout, operation, vehicle.address):
        await detect_quadplane(vehicle)
        await with_status_texts(vehicle, firmware_of(vehicle).hold())


async def _tolerance(
    vehicle: VehicleState, asked: float | None, wait: bool, timeout: float | None
) -> Tolerance:
    """Return the tolerance of a call; without `wait` nothing is read for it."""
    if not wait:
        return default_tolerance(vehicle)
    async with deadline(timeout, "reading the tolerance of", vehicle.address):
        return await tolerance_of(vehicle, asked)


def _remaining_timeout(vehicle: VehicleState, timeout: float | None, started: float) -> float | None:
    return None if timeout is None else max(timeout - (vehicle.connection.now() - started), 0.0)


def _home_of(vehicle: VehicleState) -> tuple[float, float] | None:
    home = vehicle.home
    return None if home is None else (home.latitude, home.longitude)
