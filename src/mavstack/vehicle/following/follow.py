"""`vehicle.follow(leader)`: one vehicle behind another one, by setpoints or by its firmware's own mode.

    await follower.follow(leader, offset=(-10, 5, 3), duration=60)
    await follower.follow(leader, level="radio")

Two levels serve links of different capacity. By "setpoints" this program calculates the place ten times a
second and streams it, which needs Wi-Fi and keeps the place within 0.7 m behind a leader at 3 m/s. By "radio"
the firmware flies: its Follow mode gets the leader's position five times a second, and the distance is less
exact (see `radio`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from mavstack.errors import InvalidArgumentError
from mavstack.services.arguments import check_numbers

if TYPE_CHECKING:
    from mavstack.vehicle.following.radio import FollowOptions
    from mavstack.vehicle.vehicle import Vehicle

#: The method by which a follower is controlled.
Level: TypeAlias = Literal["setpoints", "radio"]
LEVELS: Final[tuple[Level, ...]] = ("setpoints", "radio")
#: Metres forward, right and up of the leader.
DEFAULT_OFFSET: Final = (-10.0, 0.0, 0.0)


async def follow(
    vehicle: Vehicle,
    leader: Vehicle,
    offset: tuple[float, float, float] = DEFAULT_OFFSET,
    *,
    level: Level = "setpoints",
    duration: float | None = None,
    options: FollowOptions | None = None,
) -> None:
    """Follow another vehicle, and hold at the end.

    Args:
        leader: The vehicle to follow, which a pilot, a mission or another program flies.
        offset: Metres forward, right and up of the leader, in the direction in which it moves.
        level: "setpoints": streamed setpoints keep the place. "radio": the firmware's own Follow mode, with
            its parameters FOLL_… (ArduPilot) or FLW_TGT_… (PX4), which are set and keep their values.
        duration: Seconds; None: until the task is cancelled.
        options: How the vehicle follows by radio; None: the defaults.

    Raises:
        InvalidArgumentError: The offset is not possible, or the leader is the vehicle itself.
        ActionUnsupported: The vehicle type or the firmware cannot follow at this level; nothing was sent.
        ActionRefused: The vehicle is not armed, or on the ground; nothing was sent.
        ContactLost: No position of the leader, or no heartbeat of the vehicle arrives.
        ActionInterrupted: The vehicle left its mode, or stays behind.
        SwarmStopped: The guard ended the flight.
    """
    forward, right, up = offset
    check_numbers(forward=forward, right=right, up=up, duration=duration)
    if leader is vehicle:
        raise InvalidArgumentError(f"vehicle {vehicle.system} cannot follow itself")
    if level not in LEVELS:
        raise InvalidArgumentError(f"level must be one of {', '.join(LEVELS)}, got {level!r}")
    if level == "radio":
        from mavstack.vehicle.following.radio import follow_by_radio
        from mavstack.vehicle.following.settings import Place

        place = Place(forward, right, up)
        await follow_by_radio({vehicle: place}, leader, duration=duration, options=options)
        return
    from mavstack.swarm.formations import Formation
    from mavstack.vehicle.swarm import Swarm

    shape = Formation("points", points=((0.0, 0.0, 0.0), (forward, right, up)))
    async with Swarm([vehicle]) as swarm:
        await swarm.follow(leader, shape, duration=duration)
