"""One flight of a group as a swarm, bound as methods of `Group`.

Each call lets the vehicles follow setpoints, flies, and lets them hold again. Several flights in a row are
better in one `async with connection.swarm()` block, which keeps the guard between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mavstack.geodesy import LocalFrame
    from mavstack.services.mission import Plan
    from mavstack.swarm.formations import Formation
    from mavstack.swarm.search.division import Searcher
    from mavstack.swarm.search.missions import MissionOptions
    from mavstack.vehicle.following.follow import Level
    from mavstack.vehicle.group import Group, Results
    from mavstack.vehicle.swarm.controller import SwarmOptions
    from mavstack.vehicle.vehicle import Vehicle


async def formation(
    group: Group,
    formation: str | Formation,
    *,
    spacing: float | None = None,
    course: float | None = None,
    altitude: float | None = None,
    options: SwarmOptions | None = None,
    **shape: Any,  # noqa: ANN401 (those of Formation)
) -> float:
    """Fly into a formation around the first vehicle.

    Args:
        formation: The name of a shape, or a formation.
        spacing: Metres between neighbours; None: the one that any exchange of slots needs.
        course: Direction of the formation in degrees; None: north.
        altitude: Height of the leader in metres above its home; None: the one that it has.
        options: How the vehicles fly; None: the defaults.
        **shape: `angle`, `rotation`, `layers`, `layer_spacing`, `text`, `points` of `Formation`.

    Returns:
        The smallest distance of two vehicles on the way in metres, heights divided by 2.

    Raises:
        InvalidArgumentError: The group is empty, or no transition keeps the planned distance.
        SwarmStopped: The guard ended the flight.
        GroupError: A vehicle does not follow setpoints, or did not hold at the end.
    """
    from mavstack.vehicle.swarm import Swarm

    async with Swarm(group, options) as swarm:
        await swarm.formation(formation, spacing=spacing, course=course, altitude=altitude, **shape)
        return swarm.smallest_separation


async def move(
    group: Group,
    north: float = 0.0,
    east: float = 0.0,
    up: float = 0.0,
    *,
    options: SwarmOptions | None = None,
) -> float:
    """Move all vehicles by the same way, at the same time.

    Args:
        north: Metres.
        east: Metres.
        up: Metres.
        options: How the vehicles fly; None: the defaults.

    Returns:
        The smallest distance of two vehicles on the way in metres, heights divided by 2.

    Raises:
        InvalidArgumentError: The group is empty.
        SwarmStopped: The guard ended the flight.
        GroupError: A vehicle does not follow setpoints, or did not hold at the end.
    """
    from mavstack.vehicle.swarm import Swarm

    async with Swarm(group, options) as swarm:
        await swarm.move(north, east, up)
        return swarm.smallest_separation


async def goto(
    group: Group,
    latitude: float,
    longitude: float,
    altitude: float | None = None,
    *,
    options: SwarmOptions | None = None,
) -> float:
    """Move all vehicles by the same way, so that the first one arrives at a place.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above the first vehicle's home; None: the one that it has.
        options: How the vehicles fly; None: the defaults.

    Returns:
        The smallest distance of two vehicles on the way in metres, heights divided by 2.

    Raises:
        InvalidArgumentError: The group is empty.
        SwarmStopped: The guard ended the flight.
        GroupError: A vehicle does not follow setpoints, or did not hold at the end.
    """
    from mavstack.vehicle.swarm import Swarm

    async with Swarm(group, options) as swarm:
        await swarm.goto(latitude, longitude, altitude)
        return swarm.smallest_separation


async def follow(
    group: Group,
    leader: Vehicle,
    formation: str | Formation = "wedge",
    *,
    spacing: float | None = None,
    duration: float | None = None,
    level: Level = "setpoints",
    options: SwarmOptions | None = None,
    **shape: Any,  # noqa: ANN401 (those of Formation)
) -> float:
    """Follow a vehicle that another program flies; it may be in the group, and is left out then.

    Args:
        leader: The vehicle; slot 0 of the formation is its own.
        formation: The name of a shape, or a formation.
        spacing: Metres between neighbours; None: the one that any exchange of slots needs.
        duration: Seconds; None: until the task is cancelled.
        level: "setpoints", or "radio": each firmware's own Follow mode; see `Vehicle.follow`.
        options: How the vehicles fly; None: the defaults.
        **shape: `angle`, `rotation`, `layers`, `layer_spacing`, `text`, `points` of `Formation`.

    Returns:
        The smallest distance of two followers in metres, heights divided by 2.

    Raises:
        InvalidArgumentError: No vehicle is left in the group.
        ContactLost: No position of the leader arrives.
        SwarmStopped: The guard ended the flight.
        GroupError: A vehicle does not follow setpoints, or did not hold at the end.
    """
    from mavstack.vehicle.swarm import Swarm

    followers = [each for each in group if each is not leader]
    if level == "radio":
        from mavstack.vehicle.following.formation import follow_in_formation

        return await follow_in_formation(
            followers, leader, formation, spacing=spacing, duration=duration, options=options, **shape
        )
    async with Swarm(followers, options) as swarm:
        await swarm.follow(leader, formation, spacing=spacing, duration=duration, **shape)
        return swarm.smallest_separation


async def search(
    group: Group,
    pattern: str,
    center: tuple[float, float],
    *,
    size: float = 200.0,
    spacing: float = 20.0,
    bearing: float = 0.0,
    mission: MissionOptions | None = None,
    start: bool = True,
    timeout: float | None = None,
) -> Results[Plan]:
    """Divide the search around a point among the vehicles, upload a mission to each, and start them.

    Args:
        pattern: One of `mavstack.swarm.search.plans.PATTERNS`, such as "parallel".
        center: Latitude and longitude in degrees.
        size: Side of the square, or the diameter of a sector search, in metres.
        spacing: Metres between tracks.
        bearing: Direction of the pattern in degrees.
        mission: Heights and speed; None: from 30 m, each vehicle 10 m higher than the one before.
        start: Arm the vehicles, and start the missions.
        timeout: Seconds for each step of a vehicle; None: until retries are exhausted.

    Returns:
        The mission of each vehicle, or its error; those of `Mission.upload` and `Mission.start`. A vehicle
        without a part of the search is left out.

    Raises:
        InvalidArgumentError: The group is empty, or a measure is not possible.
    """
    from mavstack.files.plans import PlanFile
    from mavstack.swarm.search.missions import MissionOptions
    from mavstack.swarm.search.plans import pattern_tracks, plan_search
    from mavstack.swarm.search.surveys import frame_of

    frame = frame_of([center])
    options = mission or MissionOptions(altitude=30.0, layer_spacing=10.0)
    tracks = pattern_tracks(pattern, size, spacing, bearing)
    shares = plan_search(tracks, [searcher_of(each, frame, options.speed) for each in group], frame, options)
    missions = {each: share.items for each, share in zip(group, shares, strict=True) if share.items}

    async def fly(vehicle: Vehicle) -> Plan:
        plan = PlanFile.of(missions[vehicle]).for_vehicle(0, home_first=vehicle.component.mission.home_first)
        uploaded = await vehicle.mission.upload(plan, timeout=timeout)
        if start:
            await vehicle.mission.start(arm=True, timeout=timeout)
        return uploaded

    return await type(group)(missions).each(
        fly, name="starting the search" if start else "uploading the mission"
    )


async def land_all(group: Group, *, timeout: float | None = None) -> Results[None]:
    """Let all vehicles that are in the air land; those on the ground stay as they are.

    Args:
        timeout: Seconds for each vehicle; None sets no overall limit.

    Returns:
        The outcome of each vehicle; its errors are those of `Vehicle.land`.
    """

    async def land(vehicle: Vehicle) -> None:
        if vehicle.in_air is not False:
            await vehicle.land(timeout=timeout)

    return await group.each(land, name="landing")


def searcher_of(vehicle: Vehicle, frame: LocalFrame, speed: float | None) -> Searcher:
    """Return a vehicle as the planner of searches takes it: its speed, and where it is."""
    from mavstack.swarm.search.division import Searcher
    from mavstack.swarm.search.surveys import to_metres

    position = vehicle.position
    start = None if position is None else to_metres(frame, [(position.latitude, position.longitude)])[0]
    return Searcher(speed or vehicle.vehicle_type.typical_speed, start=start)
