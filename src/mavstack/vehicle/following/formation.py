"""A formation behind a leader, kept by the followers' firmwares."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.swarm.assignment import assign_slots
from mavstack.swarm.formations import Formation, default_spacing, rotate_to_course
from mavstack.swarm.separation import nearest_pair
from mavstack.vehicle.following.radio import FollowOptions, follow_by_radio
from mavstack.vehicle.following.settings import Place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Points
    from mavstack.vehicle.swarm.controller import SwarmOptions
    from mavstack.vehicle.vehicle import Vehicle


async def follow_in_formation(
    followers: Sequence[Vehicle],
    leader: Vehicle,
    formation: str | Formation,
    *,
    spacing: float | None = None,
    duration: float | None = None,
    options: SwarmOptions | None = None,
    **shape: Any,  # noqa: ANN401 (those of Formation)
) -> float:
    """Follow a leader in a formation by the firmwares' own modes; see `Group.follow`.

    Each follower gets the slot that makes the ways to all slots short, so that ways do not cross.
    """
    from mavstack.vehicle.swarm.controller import SwarmOptions

    if not followers:
        raise InvalidArgumentError("a group that follows must have a vehicle beside the leader")
    chosen = options or SwarmOptions()
    if not isinstance(formation, Formation):
        distance = default_spacing(formation, chosen.margins.planned_distance)
        formation = Formation(formation, spacing=spacing or distance, **shape)
    offsets = formation.offsets(len(followers) + 1)[1:]
    apart, _, _ = nearest_pair(offsets)
    if apart < chosen.margins.planned_distance:
        raise InvalidArgumentError(
            f"slots must be at least {chosen.margins.planned_distance:.1f} m apart, got {apart:.1f} m"
        )
    for vehicle in (leader, *followers):
        await vehicle.wait_for_message(common.GlobalPositionInt)
    slots = assign_slots(_places(followers, leader), rotate_to_course(offsets, _heading(leader)))
    places = {vehicle: Place(*offsets[slot].tolist()) for vehicle, slot in zip(followers, slots, strict=True)}
    radio = FollowOptions(guard=chosen.guard)
    return await follow_by_radio(places, leader, duration=duration, options=radio)


def _places(followers: Sequence[Vehicle], leader: Vehicle) -> Points:
    """Return where the followers are, in metres north, east, up of the leader."""
    origin = leader.latest(common.GlobalPositionInt)
    messages = [vehicle.latest(common.GlobalPositionInt) for vehicle in followers]
    if origin is None:
        return np.zeros((len(followers), 3))
    frame = LocalFrame(origin.lat / 1e7, origin.lon / 1e7, origin.alt / 1e3)
    found = [
        (0.0, 0.0, 0.0) if each is None else frame.to_local(each.lat / 1e7, each.lon / 1e7, each.alt / 1e3)
        for each in messages
    ]
    return np.array(found) * (1.0, 1.0, -1.0)


def _heading(leader: Vehicle) -> float:
    message = leader.latest(common.GlobalPositionInt)
    return 0.0 if message is None else message.hdg / 100.0
