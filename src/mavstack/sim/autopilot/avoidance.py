"""Avoidance of obstacles as the firmwares do it without planning a path: the vehicle stops before them.

A velocity that a pilot or a program asks for is limited so that the vehicle can brake before the margin
(`LimitedVelocity`). A flight to a point ends at the margin (`PathStop`): the simulated planner finds no way
around an obstacle.
"""

from __future__ import annotations

from math import atan2, hypot, inf, sqrt
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

#: Share of the maximum acceleration that braking before an obstacle uses.
_BRAKING: Final = 0.35
#: Maximum speed in m/s for each metre to the margin, so that the last metre is flown gently.
_GAIN: Final = 0.5
#: Seconds until a demand takes effect.
_DELAY: Final = 0.4
_MIN_SPEED: Final = 0.01
#: Metres by which a target must lie beyond the margin.
_BEYOND: Final = 0.5


class LimitedVelocity:
    """The limit of demanded velocities; `margin` returns the metres to keep, or None while it is off."""

    def __init__(self, autopilot: SimulatedAutopilot, margin: Callable[[], float | None]) -> None:
        self._autopilot, self._margin = autopilot, margin
        autopilot.body.velocity_filter = self.limit

    def limit(self, north: float, east: float, down: float) -> Point:
        """Return a velocity in m/s that lets the vehicle stop before the margin of an obstacle."""
        speed, margin = hypot(north, east), self._margin()
        if margin is None or speed < _MIN_SPEED:
            return north, east, down
        clearance = _clearance(self._autopilot, atan2(east, north), margin)
        share = min(_approach_speed(self._autopilot, clearance) / speed, 1.0)
        return north * share, east * share, down


class PathStop:
    """Stops a flight to a point before an obstacle; runs on each tick."""

    def __init__(self, autopilot: SimulatedAutopilot, margin: Callable[[], float | None]) -> None:
        self._autopilot, self._margin = autopilot, margin

    def tick(self, now: float) -> None:
        """Hold the position if the way to the target leads to an obstacle that is near."""
        autopilot, margin = self._autopilot, self._margin()
        target = autopilot.target
        if margin is None or target is None or autopilot.landed:
            return
        maneuvers, here = autopilot.maneuvers, autopilot.body.estimate
        speed = hypot(here.velocity_north, here.velocity_east)
        course = maneuvers.bearing(target)
        clearance = _clearance(autopilot, course, margin)
        near = clearance <= speed * speed / _braking(autopilot) + speed * _DELAY
        if near and clearance + _BEYOND < maneuvers.distance(target):
            maneuvers.hold(maneuvers.ahead(clearance, course))


def _clearance(autopilot: SimulatedAutopilot, course: float, margin: float) -> float:
    truth = autopilot.body.truth
    return autopilot.body.surroundings.clearance_along((truth.north, truth.east, truth.down), course, margin)


def _approach_speed(autopilot: SimulatedAutopilot, clearance: float) -> float:
    """Return the speed from which the vehicle can stop within a distance."""
    if clearance == inf:
        return inf
    return min(sqrt(_braking(autopilot) * clearance), _GAIN * clearance)


def _braking(autopilot: SimulatedAutopilot) -> float:
    """Return twice the deceleration in m/s2 with which the vehicle stops."""
    return 2 * _BRAKING * max(autopilot.body.limits.acceleration, 0.1)
