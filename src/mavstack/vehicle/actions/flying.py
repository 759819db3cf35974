"""Going somewhere, circling and turning: requested as the firmware wants it, and monitored.

Preconditions are checked before anything is sent (`preconditions`), and the steps of a request that fails are
reversed (`firmware.changes`). An action is complete when the telemetry shows it, not when the firmware
acknowledges it:

    goto      arrived (see `arrival`): settled within the tolerance; a wing: on the circle around the location
    orbit     on the circle, in its direction (see `orbiting`)
    turn      within five degrees
"""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ActionTimeout
from mavstack.geodesy import offset_location
from mavstack.services.arguments import check_number, check_numbers
from mavstack.vehicle.action_monitor import MIN_PROGRESS, STALL_TIMEOUT, ActionGoal
from mavstack.vehicle.actions.arrival import MAX_APPROACHES, Arrival, check_tolerance, tolerance_if_waiting
from mavstack.vehicle.actions.limits import check_location, check_target, explain_far_target
from mavstack.vehicle.actions.orbiting import Orbiting, check_radius
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.actions.quadplane import detect_quadplane
from mavstack.vehicle.actions.running import remaining_timeout, run_action
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import Firmware, firmware_of
from mavstack.vehicle.geography import Location
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.vehicle.firmware.changes import Changes
    from mavstack.vehicle.vehicle import Vehicle

_HEADING_TOLERANCE: Final = 5.0
#: The time without progress after which a call fails on a wing, in seconds: such a vehicle turns and climbs
#: on its way.
_WING_STALL_TIMEOUT: Final = 60.0


async def goto(
    vehicle: Vehicle,
    latitude: float,
    longitude: float,
    altitude: float | None = None,
    *,
    yaw: float | None = None,
    radius: float | None = None,
    tolerance: float | None = None,
    override_limits: bool = False,
    wait: bool = True,
    timeout: float | None = None,
) -> None:
    """Go to a global position and stay there (MAV_CMD_DO_REPOSITION).

    A vehicle that stops has arrived when it is within the tolerance and slow. By default that is 0.5 m
    for copters, submarines (0.2 m of depth) and rovers, 1 m for boats and hovering VTOLs; rovers and
    boats that stop within a larger radius by their parameters (WP_RADIUS, LOIT_RADIUS, NAV_ACC_RAD)
    arrive within it. Rovers and boats have no altitude. A wing has arrived when it circles the position
    within 5 m of the altitude, or within `tolerance`; with it, passing that closely is enough too.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above home; None keeps the present altitude.
        yaw: Heading in degrees; None leaves it to the vehicle.
        radius: Metres of the circle that a wing flies around the position; None: the vehicle's default.
        tolerance: Metres from the position, over ground and in altitude, at which the vehicle has
            arrived; None: the default of its type.
        override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
        wait: Wait until the vehicle has arrived.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        InvalidTypeError: An argument is not a number.
        InvalidArgumentError: The position is not one on Earth, or implausibly far, high or low.
        ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
        ActionUnsupported: The vehicle type or the firmware does not support it, such as a radius that the
            version ignores, or a tolerance below the radius within which it stops; nothing was changed.
        ActionTimeout: It was not complete within `timeout`, or its progress stalled, such as a vehicle
            that does not meet the tolerance; the text says by how much.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    await _go(
        vehicle,
        Location(latitude, longitude, altitude),
        yaw=yaw,
        radius=radius,
        tolerance=tolerance,
        override_limits=override_limits,
        wait=wait,
        timeout=timeout,
    )


async def _go(
    vehicle: Vehicle,
    location: Location,
    *,
    yaw: float | None = None,
    radius: float | None = None,
    tolerance: float | None = None,
    override_limits: bool = False,
    wait: bool = True,
    timeout: float | None = None,
    changes: Changes | None = None,
) -> None:
    """Go to a location; `changes` are those of the call that this one is a part of."""
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
    limits = await tolerance_if_waiting(vehicle, tolerance, wait, timeout)
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
        failure=arrival.miss,
    )
    for approach in range(1, MAX_APPROACHES + 1):
        request = firmware.goto(location, yaw=yaw, radius=radius)
        left = remaining_timeout(vehicle, timeout, started)
        try:
            with explain_far_target(vehicle, location), closing(arrival.begin_approach()):
                await run_action(
                    vehicle,
                    operation,
                    request,
                    lambda: goal,
                    changes=firmware.changes,
                    wait=wait,
                    timeout=left,
                )
        except ActionTimeout:
            if arrival.missed_by is None or approach == MAX_APPROACHES:
                raise
        else:
            return


async def move(
    vehicle: Vehicle,
    north: float = 0.0,
    east: float = 0.0,
    up: float = 0.0,
    *,
    tolerance: float | None = None,
    override_limits: bool = False,
    wait: bool = True,
    timeout: float | None = None,
) -> None:
    """Move by a distance from the present position (MAV_CMD_DO_REPOSITION).

    Args:
        north: Metres to the north.
        east: Metres to the east.
        up: Metres upwards; rovers and boats have no altitude.
        tolerance: Metres from the position at which the vehicle has arrived; None: as for `goto`.
        override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
        wait: Wait until the vehicle has arrived.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        InvalidTypeError: An argument is not a number.
        InvalidArgumentError: The position is implausibly far, high or low.
        MessageTimeout: The vehicle did not report its position.
        ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
        ActionUnsupported: The vehicle type or the firmware does not support it, such as a change of
            altitude by a rover; nothing was changed.
        ActionTimeout: It was not complete within `timeout`, or its progress stalled, as for `goto`.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    check_numbers(north=north, east=east, up=up)
    check_tolerance(tolerance)
    if up and not vehicle.vehicle_type.has_altitude:
        raise firmware_of(vehicle).unsupported("move up or down")
    check_preconditions(vehicle, "goto", "moving")
    started = vehicle.connection.now()
    async with deadline(timeout, "moving", vehicle.address):
        position = await vehicle.get_position()
    altitude = None if not up else (position.relative_altitude or 0.0) + up
    location = Location(*offset_location(position.latitude, position.longitude, north, east), altitude)
    timeout = remaining_timeout(vehicle, timeout, started)
    await _go(
        vehicle, location, tolerance=tolerance, override_limits=override_limits, wait=wait, timeout=timeout
    )


async def orbit(
    vehicle: Vehicle,
    latitude: float,
    longitude: float,
    altitude: float | None = None,
    *,
    radius: float = 20.0,
    speed: float | None = None,
    tolerance: float | None = None,
    override_limits: bool = False,
    wait: bool = True,
    timeout: float | None = None,
) -> None:
    """Circle a global position (MAV_CMD_DO_ORBIT, or the firmware's mode for it).

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above home; None keeps the present altitude.
        radius: Metres; negative: counter-clockwise.
        speed: Metres per second; None leaves it to the vehicle.
        tolerance: Metres by which radius and altitude may differ; None: a tenth of the radius, at
            least 1; on a wing a quarter of it, at least 10.
        override_limits: Send a position or an altitude that lies beyond the limits of plausible flights.
        wait: Wait until the vehicle is on the circle, in the direction that was asked for.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        InvalidTypeError: An argument is not a number.
        InvalidArgumentError: The position is not one on Earth, or implausible, or the radius is 0.
        ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
        ActionUnsupported: The vehicle type or the firmware does not support it, such as a radius that the
            version ignores; the text names the parameter that sets it. Nothing was changed.
        ActionTimeout: It was not complete within `timeout`, its progress stalled, or the vehicle flies
            another circle, or the other way round.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    center = Location(latitude, longitude, altitude)
    check_numbers(speed=speed)
    check_tolerance(tolerance)
    check_radius(radius)
    operation = f"orbit of {abs(radius):g} m radius with"
    check_preconditions(vehicle, "orbit", operation)
    started = vehicle.connection.now()
    await check_target(vehicle, center, override_limits=override_limits, timeout=timeout)
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    await firmware.check_circle(radius, orbit=True)
    timeout = remaining_timeout(vehicle, timeout, started)
    orbiting = Orbiting(vehicle, center, radius, tolerance)

    goal = _orbit_goal(vehicle, firmware, orbiting)
    request = _request_orbit(vehicle, firmware, center, radius, speed)
    with explain_far_target(vehicle, center):
        await run_action(
            vehicle, operation, request, lambda: goal, changes=firmware.changes, wait=wait, timeout=timeout
        )


def _orbit_goal(vehicle: Vehicle, firmware: Firmware, orbiting: Orbiting) -> ActionGoal:
    return ActionGoal(
        orbiting.reached,
        orbiting.remaining,
        modes=firmware.modes_of("orbit"),
        armed=True,
        stall_timeout=_WING_STALL_TIMEOUT if vehicle.vehicle_type.circles else STALL_TIMEOUT,
        signs=orbiting.signs,
        detail=orbiting.detail,
        failure=orbiting.failure,
    )


async def _request_orbit(
    vehicle: Vehicle, firmware: Firmware, center: Location, radius: float, speed: float | None
) -> None:
    entry = await firmware.prepare_orbit(center, radius)
    if entry is not None:
        heading, changes = entry.heading, firmware.changes
        await _go(vehicle, entry.location, yaw=heading, override_limits=True, changes=changes)
        if heading is not None:
            await _turn(vehicle, heading, changes=changes)
    await firmware.orbit(center, radius=radius, speed=speed)


async def set_yaw(
    vehicle: Vehicle, heading: float, *, wait: bool = True, timeout: float | None = None
) -> None:
    """Turn to a heading on the spot.

    Args:
        heading: Degrees clockwise from north; 500 is the same as 140.
        wait: Wait until the vehicle has turned.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        InvalidTypeError: The heading is not a number.
        InvalidArgumentError: The heading is not finite.
        ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    await _turn(vehicle, heading, wait=wait, timeout=timeout)


async def _turn(
    vehicle: Vehicle,
    heading: float,
    *,
    wait: bool = True,
    timeout: float | None = None,
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


async def hold(vehicle: Vehicle, *, timeout: float | None = None) -> None:
    """Hold the present position; a wing circles.

    Args:
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Raises:
        ActionRefused: The vehicle is not armed; nothing was sent.
        CommandDenied: The vehicle refused the mode.
        ModeTimeout: The vehicle accepted the mode and did not enter it.
        ActionTimeout: The call did not end within `timeout`.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    operation = "holding the position of"
    check_preconditions(vehicle, "hold", operation)
    async with deadline(timeout, operation, vehicle.address):
        await detect_quadplane(vehicle)
        await with_status_texts(vehicle, firmware_of(vehicle).hold())


async def set_speed(
    vehicle: Vehicle,
    speed: float,
    speed_type: int = common.SpeedType.GROUNDSPEED,
    *,
    timeout: float | None = None,
) -> None:
    """Set the speed of flight (MAV_CMD_DO_CHANGE_SPEED).

    Args:
        speed: Metres per second.
        speed_type: The SPEED_TYPE; the default is the speed over ground.
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Raises:
        InvalidTypeError: The speed is not a number.
        InvalidArgumentError: The speed is not finite.
        CommandDenied: The vehicle refused.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    check_numbers(speed=speed, speed_type=speed_type)
    check_preconditions(vehicle, "speed", "setting the speed of")
    command = vehicle.component.command(common.MavCmd.DO_CHANGE_SPEED, speed_type, speed, -1, timeout=timeout)
    await with_status_texts(vehicle, command)
