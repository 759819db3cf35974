"""Avoidance of obstacles as the firmwares do it: a vehicle stops before them, or moves around them.

A velocity that a pilot or a program asks for is limited so that the vehicle can brake before the margin
(`LimitedVelocity`). A flight to a point ends at the margin (`PathStop`). A vehicle on the surface takes the
free course that deviates least from the one to its target (`PathAround`), as ArduPilot's BendyRuler does.
"""

from __future__ import annotations

from math import atan2, hypot, inf, radians, sqrt
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

#: Share of the maximum acceleration that is used to brake before an obstacle.
_BRAKING: Final = 0.35
#: Maximum speed in m/s for each metre that is left to the margin; it slows the vehicle in the last metres.
_GAIN: Final = 0.5
#: Seconds that the vehicle needs to react to a demand.
_DELAY: Final = 0.4
_MIN_SPEED: Final = 0.01
#: The vehicle stops before an obstacle only if the target is at least this many metres farther than the
#: margin around the obstacle.
_BEYOND: Final = 0.5
#: Turns from the direct course that are tried, in degrees, and the preference in degrees for the side of the
#: last turn.
_TURNS: Final = tuple(range(5, 171, 5))
_SAME_SIDE: Final = 30


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


class PathAround:
    """Leads a vehicle around obstacles to its target; runs on each tick.

    Args:
        autopilot: The autopilot.
        margin: Returns the metres to keep from obstacles; None while it is off.
        lookahead: Returns the metres that a course must be free.
    """

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        margin: Callable[[], float | None],
        lookahead: Callable[[], float],
    ) -> None:
        self._autopilot, self._margin, self._lookahead = autopilot, margin, lookahead
        #: The target behind the obstacles, and the intermediate point to which the vehicle flies first.
        self._goal: Point | None = None
        self._via: Point | None = None
        self._side = 0

    def tick(self, now: float) -> None:
        """Turn aside if the way to the target is blocked nearby, and back when it is free."""
        autopilot, margin = self._autopilot, self._margin()
        if self._goal is not None and autopilot.target != self._via:
            self._goal = self._via = None  # another command changed the target
        target = self._goal or autopilot.target
        if margin is None or target is None or not autopilot.armed:
            return
        maneuvers = autopilot.maneuvers
        course, distance = maneuvers.bearing(target), maneuvers.distance(target)
        wanted = min(self._lookahead(), distance)
        if _clearance(autopilot, course, margin) >= wanted - _BEYOND:
            if self._goal is not None:
                self._goal = self._via = None
                maneuvers.go_to(target)
            return
        turn = self._free_turn(course, margin)
        self._goal = target
        if turn is None:
            self._via = maneuvers.hold()
            return
        self._side = 1 if turn > 0 else -1
        self._via = maneuvers.ahead(self._lookahead(), course + turn)
        maneuvers.go_to(self._via)

    def _free_turn(self, course: float, margin: float) -> float | None:
        """Return the smallest turn to a free course, in radians; None if there is none."""
        turns = sorted(
            (turn * side for turn in _TURNS for side in (1, -1)),
            key=lambda turn: abs(turn) - (_SAME_SIDE if turn * self._side > 0 else 0),
        )
        for turn in turns:
            if _clearance(self._autopilot, course + radians(turn), margin) >= self._lookahead():
                return radians(turn)
        return None


def _clearance(autopilot: SimulatedAutopilot, course: float, margin: float) -> float:
    truth, clearance = autopilot.body.truth, inf
    if autopilot.vehicle.proximity:
        here = truth.north, truth.east, truth.down
        clearance = autopilot.body.surroundings.clearance_along(here, course, margin)
    reported = autopilot.obstacle_input
    if reported is None:
        return clearance
    return min(clearance, reported.clearance_along(autopilot.now, course, margin))


def _approach_speed(autopilot: SimulatedAutopilot, clearance: float) -> float:
    """Return the speed from which the vehicle can stop within a distance."""
    if clearance == inf:
        return inf
    return min(sqrt(_braking(autopilot) * clearance), _GAIN * clearance)


def _braking(autopilot: SimulatedAutopilot) -> float:
    """Return twice the deceleration in m/s2 with which the vehicle stops."""
    return 2 * _BRAKING * max(autopilot.body.limits.acceleration, 0.1)
