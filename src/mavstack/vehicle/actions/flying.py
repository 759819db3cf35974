"""Taking off, landing, returning, going somewhere: requested as the firmware wants it, and monitored.

An action is complete when the telemetry shows it, not when the firmware acknowledges it:

    takeoff   within a metre or a twentieth of the altitude; a plane: from 3 metres or a sixteenth below it
    land      on the ground and disarmed, or on the ground for a while
    rtl       the same; a vehicle that does not land there: at home, within its circle
    goto      within the radius; a wing: on the circle around the location
    orbit     on the circle
    turn      within five degrees
"""

from __future__ import annotations

from contextlib import suppress
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError, RemoteError
from mavstack.services.arguments import check_number, check_numbers
from mavstack.vehicle.action_monitor import STALL_TIMEOUT, ActionGoal, ActionMonitor
from mavstack.vehicle.actions.conditions import LandingDetector, SustainedCondition
from mavstack.vehicle.actions.limits import check_takeoff, check_target, explain_far_target
from mavstack.vehicle.actions.quadplane import detect_quadplane
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.geography import Location, distance, offset_location
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any

    from mavstack.vehicle.vehicle_state import VehicleState

#: The distance within which a vehicle that hovers or drives has arrived, in metres.
ARRIVAL_RADIUS: Final = 2.0
#: The distance within which a wing circles a location with its default radius, in metres.
WING_ARRIVAL_RADIUS: Final = 120.0
#: The largest ratio of the distance to a location and the radius of the circle around it.
CIRCLE_MARGIN: Final = 1.3
#: The distance to the circle of an orbit within which the vehicle is on it, in metres.
ORBIT_TOLERANCE: Final = 5.0
ALTITUDE_TOLERANCE: Final = 2.0
WING_ALTITUDE_TOLERANCE: Final = 10.0
_HEADING_TOLERANCE: Final = 5.0
#: A vehicle that circles home for so long is not going to land, in seconds: some quadplanes do not.
CIRCLING_TIME: Final = 30.0
#: The time in which the remaining distance of a return may not fall, in seconds.
_RETURN_STALL_TIMEOUT: Final = 90.0
#: The same for a wing that keeps its altitude in a landing pattern, and for a return to an unknown home.
_PATTERN_STALL_TIMEOUT: Final = 600.0


async def _run(
    vehicle: VehicleState,
    operation: str,
    request: Coroutine[Any, Any, None],
    goal: Callable[[], ActionGoal],
    *,
    wait: bool,
    timeout: float | None,
) -> None:
    """Request an action, and wait until its goal is reached."""
    try:
        async with ActionMonitor(vehicle, operation, timeout) as monitor:
            await with_status_texts(vehicle, request)
            if wait:
                await monitor.wait_until_reached(goal())
    finally:
        request.close()  # if it was never awaited


async def takeoff(
    vehicle: VehicleState, altitude: float, *, override_limits: bool, wait: bool, timeout: float | None
) -> None:
    """Take off to an altitude in metres above home."""
    check_takeoff(altitude, override_limits=override_limits)
    firmware_of(vehicle).check_supported("takeoff")
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    wing = vehicle.vehicle_type is VehicleType.PLANE
    # ArduPlane ends its climb some metres below the altitude, which it counts from the start, not from home.
    tolerance = max(3.0, altitude / 16) if wing else max(1.0, altitude / 20)

    def remaining() -> float | None:
        height = _relative_altitude(vehicle)
        if height is None:
            return None
        return max(altitude - height, 0.0) if wing else abs(altitude - height)

    goal = ActionGoal(
        lambda: (rest := remaining()) is not None and rest <= tolerance,
        remaining,
        modes=firmware.modes_of("takeoff"),
        armed=True,
    )
    operation = f"takeoff to {altitude:g} m of"
    try:
        await _run(vehicle, operation, firmware.takeoff(altitude), lambda: goal, wait=wait, timeout=timeout)
    except CommandDenied as error:
        if vehicle.armed is False:
            # ArduPilot sends no status text for this reason.
            error.status_texts = error.status_texts or ("the vehicle is disarmed",)
        raise


async def land(vehicle: VehicleState, *, wait: bool, timeout: float | None) -> None:
    """Land, and wait until the motors stand still."""
    firmware_of(vehicle).check_supported("land")
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    plane = vehicle.vehicle_type is VehicleType.PLANE
    goal = ActionGoal(
        LandingDetector(vehicle).has_landed,
        lambda: _relative_altitude(vehicle),
        modes=firmware.modes_of("land"),
        stall_timeout=_PATTERN_STALL_TIMEOUT if plane else STALL_TIMEOUT,
    )
    await _run(vehicle, "landing", firmware.land(), lambda: goal, wait=wait, timeout=timeout)


async def rtl(vehicle: VehicleState, *, wait: bool, timeout: float | None) -> None:
    """Return to home, and land there if the vehicle does that; it need not report where home is."""
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    landing = LandingDetector(vehicle)
    stays = not vehicle.vehicle_type.flies or vehicle.vehicle_type is VehicleType.PLANE
    radius = WING_ARRIVAL_RADIUS if vehicle.vehicle_type.circles else ARRIVAL_RADIUS

    async def request() -> None:
        await firmware.rtl()
        if wait:
            with suppress(RemoteError):
                await vehicle.get_home()

    def home_distance() -> float | None:
        home = vehicle.home
        return None if home is None else _distance_to(vehicle, home.latitude, home.longitude)

    def remaining() -> float | None:
        away, height = home_distance(), _relative_altitude(vehicle)
        return None if away is None or height is None else away + abs(height)

    circling = SustainedCondition(vehicle, CIRCLING_TIME)

    def reached() -> bool:
        away = home_distance()
        at_home = away is not None and away <= radius
        landed = vehicle.vehicle_type.flies and landing.has_landed()
        return landed or (stays and at_home) or circling.update(at_home and flies_on_wing(vehicle))

    def goal() -> ActionGoal:
        stall_timeout = _PATTERN_STALL_TIMEOUT if vehicle.home is None else _RETURN_STALL_TIMEOUT
        return ActionGoal(reached, remaining, modes=firmware.modes_of("rtl"), stall_timeout=stall_timeout)

    await _run(vehicle, "return to launch of", request(), goal, wait=wait, timeout=timeout)


async def move(
    vehicle: VehicleState,
    offset: tuple[float, float, float],
    *,
    override_limits: bool,
    wait: bool,
    timeout: float | None,
) -> None:
    """Go to the location at an offset in metres (north, east, up) from the vehicle."""
    firmware_of(vehicle).check_supported("goto")
    north, east, up = offset
    started = vehicle.connection.now()
    async with deadline(timeout, "moving", vehicle.address):
        position = await vehicle.get_position()
    altitude = None if not up else (position.relative_altitude or 0.0) + up
    location = Location(*offset_location(position.latitude, position.longitude, north, east), altitude)
    timeout = _remaining_timeout(vehicle, timeout, started)
    await goto(
        vehicle, location, yaw=None, radius=None, override_limits=override_limits, wait=wait, timeout=timeout
    )


async def goto(
    vehicle: VehicleState,
    location: Location,
    *,
    yaw: float | None,
    radius: float | None,
    override_limits: bool,
    wait: bool,
    timeout: float | None,
) -> None:
    """Go to a location and stay there."""
    check_numbers(yaw=yaw, radius=radius)
    firmware_of(vehicle).check_supported("goto")
    started = vehicle.connection.now()
    await check_target(vehicle, location, override_limits=override_limits, timeout=timeout)
    timeout = _remaining_timeout(vehicle, timeout, started)
    await detect_quadplane(vehicle)
    _check_airborne(vehicle, "go to a location")
    firmware = firmware_of(vehicle)
    wing_radius = WING_ARRIVAL_RADIUS if radius is None else radius * CIRCLE_MARGIN

    def errors() -> tuple[float, float] | None:
        away = _distance_to(vehicle, location.latitude, location.longitude)
        height = _relative_altitude(vehicle)
        if away is None or height is None:
            return None
        return away, 0.0 if location.altitude is None else abs(location.altitude - height)

    def reached() -> bool:
        wing = flies_on_wing(vehicle)
        tolerances = (wing_radius, WING_ALTITUDE_TOLERANCE) if wing else (ARRIVAL_RADIUS, ALTITUDE_TOLERANCE)
        rest = errors()
        return rest is not None and rest[0] <= tolerances[0] and rest[1] <= tolerances[1]

    goal = ActionGoal(
        reached,
        lambda: None if (rest := errors()) is None else sum(rest),
        modes=firmware.modes_of("goto"),
        armed=True,
    )
    operation = f"going to {location.latitude:.6f}, {location.longitude:.6f} with"
    request = firmware.goto(location, yaw=yaw, radius=radius)
    with explain_far_target(vehicle, location):
        await _run(vehicle, operation, request, lambda: goal, wait=wait, timeout=timeout)


async def orbit(
    vehicle: VehicleState,
    center: Location,
    *,
    radius: float,
    speed: float | None,
    override_limits: bool,
    wait: bool,
    timeout: float | None,
) -> None:
    """Circle a location."""
    check_numbers(speed=speed)
    check_number("radius", radius, finite=False)
    if not (isfinite(radius) and radius):
        raise InvalidArgumentError(
            f"orbit radius must be finite and not 0 (negative: counter-clockwise), got {radius}"
        )
    firmware_of(vehicle).check_supported("orbit")
    started = vehicle.connection.now()
    await check_target(vehicle, center, override_limits=override_limits, timeout=timeout)
    timeout = _remaining_timeout(vehicle, timeout, started)
    _check_airborne(vehicle, "orbit")
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    tolerance = max(ORBIT_TOLERANCE, abs(radius) / 4)

    async def request() -> None:
        entry = await firmware.prepare_orbit(center, radius)
        if entry is not None:
            await goto(
                vehicle, entry.location, yaw=entry.heading, radius=None,
                override_limits=True, wait=True, timeout=None,
            )  # fmt: skip
            if entry.heading is not None:
                await turn(vehicle, entry.heading, wait=True, timeout=None)
        await firmware.orbit(center, radius=radius, speed=speed)

    def remaining() -> float | None:
        away = _distance_to(vehicle, center.latitude, center.longitude)
        return None if away is None else abs(away - abs(radius))

    goal = ActionGoal(
        lambda: (rest := remaining()) is not None and rest <= tolerance,
        remaining,
        modes=firmware.modes_of("orbit"),
        armed=True,
    )
    operation = f"orbit of {abs(radius):g} m radius with"
    with explain_far_target(vehicle, center):
        await _run(vehicle, operation, request(), lambda: goal, wait=wait, timeout=timeout)


async def turn(vehicle: VehicleState, heading: float, *, wait: bool, timeout: float | None) -> None:
    """Turn to a heading in degrees."""
    check_number("heading", heading)
    firmware_of(vehicle).check_supported("turn")
    heading %= 360.0
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)

    def remaining() -> float | None:
        now = vehicle.heading
        return None if now is None else abs((now - heading + 180.0) % 360.0 - 180.0)

    goal = ActionGoal(
        lambda: (rest := remaining()) is not None and rest <= _HEADING_TOLERANCE,
        remaining,
        "degrees",
        modes=firmware.modes_of("turn"),
    )
    operation = f"turn to {heading:g} degrees of"
    await _run(vehicle, operation, firmware.turn(heading), lambda: goal, wait=wait, timeout=timeout)


async def hold(vehicle: VehicleState, *, timeout: float | None) -> None:
    """Stay at the present position."""
    async with deadline(timeout, "holding the position of", vehicle.address):
        await detect_quadplane(vehicle)
        await with_status_texts(vehicle, firmware_of(vehicle).hold())


def flies_on_wing(vehicle: VehicleState) -> bool:
    """Return whether the vehicle flies on its wing now, and cannot stand still."""
    hovers = vehicle.vtol_state == common.MavVtolState.MC
    kind = vehicle.vehicle_type
    return kind is VehicleType.PLANE or (kind is VehicleType.VTOL and not hovers)


def _check_airborne(vehicle: VehicleState, action: str) -> None:
    """Raise if a plane stands on the ground: it would run along it at full throttle."""
    if vehicle.vehicle_type is VehicleType.PLANE and vehicle.armed and vehicle.in_air is False:
        raise firmware_of(vehicle).unsupported(action, "it is on the ground; take off first")


def _remaining_timeout(vehicle: VehicleState, timeout: float | None, started: float) -> float | None:
    return None if timeout is None else max(timeout - (vehicle.connection.now() - started), 0.0)


def _relative_altitude(vehicle: VehicleState) -> float | None:
    position = vehicle.position
    return None if position is None else position.relative_altitude


def _distance_to(vehicle: VehicleState, latitude: float, longitude: float) -> float | None:
    position = vehicle.position
    if position is None:
        return None
    return distance(position.latitude, position.longitude, latitude, longitude)
