"""A leader as its messages describe it, for the modes in which a vehicle follows another one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.sim.autopilot.maneuvers import Point


@dataclass(frozen=True, slots=True)
class LeaderReport:
    """One message of a leader.

    Attributes:
        position: Local metres north, east, down of the follower's frame.
        velocity: North, east, down in m/s.
        heading: Radians; None if unknown.
        received_at: Unix seconds.
    """

    position: Point
    velocity: Point
    heading: float | None
    received_at: float

    def position_at(self, now: float) -> Point:
        """Return the position that the velocity leads to, in local metres."""
        passed = now - self.received_at
        north, east, down = (
            place + speed * passed for place, speed in zip(self.position, self.velocity, strict=True)
        )
        return north, east, down
