"""The motion of a leader that another program flies, measured while its followers fly."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING

from mavstack.errors import ContactLost
from mavstack.vehicle.swarm.fleet import read_states
from mavstack.vehicle.swarm.member import RATE

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.leader import LeaderFrame
    from mavstack.vehicle.swarm.member import Member


async def fly_with_leader(
    flight: Awaitable[None], leader: Member, motion: LeaderFrame, frame: LocalFrame, link_age: float
) -> None:
    """Measure a leader while its followers fly, to the end of their flight.

    Args:
        flight: The flight; it is cancelled if the leader is lost.
        leader: The leader.
        motion: Takes the measurements.
        frame: The frame of the followers.
        link_age: Seconds after which the leader is lost.

    Raises:
        ContactLost: No position of the leader arrives.
    """
    watch = asyncio.create_task(_measure(leader, motion, frame, link_age))
    flying = asyncio.ensure_future(flight)
    try:
        await asyncio.wait((watch, flying), return_when=asyncio.FIRST_COMPLETED)
        if watch.done():
            watch.result()  # raises ContactLost
        await flying
    finally:
        watch.cancel()
        flying.cancel()
        with suppress(asyncio.CancelledError):
            await flying


def measure(leader: Member, motion: LeaderFrame, frame: LocalFrame) -> float:
    """Take one measurement, and return the age of the leader's position in seconds."""
    now = leader.vehicle.connection.now()
    found = read_states([leader], frame, now)
    motion.update(found.positions[0], found.velocities[0], now)
    return float(found.ages[0])


async def _measure(leader: Member, motion: LeaderFrame, frame: LocalFrame, link_age: float) -> None:
    while measure(leader, motion, frame) <= link_age:  # noqa: ASYNC110 (nothing happens when it is lost)
        await asyncio.sleep(1.0 / RATE)
    raise ContactLost("following", str(leader.vehicle.address), answer="no position arrives")
