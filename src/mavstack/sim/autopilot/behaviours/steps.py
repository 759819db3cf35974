"""Parts of scripts that several behaviours have in common; each is a generator to `yield from`."""

from __future__ import annotations

from math import copysign
from typing import TYPE_CHECKING

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.autopilot.maneuvers import Point

#: A transition that takes longer than this is given up waiting for.
_TRANSITION_LIMIT = 40.0
_ON_THE_WING = 0.95
#: Throttle for one m/s of error in climb, and how fast the throttle of hovering is learnt.
_CLIMB_GAIN, _CLIMB_LEARNING = 0.1, 0.01
_HOVER = 0.5


def wait(autopilot: Autopilot, seconds: float) -> Iterator[None]:
    """Let time pass."""
    end = autopilot.now + seconds
    while autopilot.now < end:
        yield


def stay_landed(autopilot: Autopilot) -> Iterator[None]:
    """Idle for as long as the vehicle is on the ground, if it is one that flies."""
    if autopilot.vehicle.type.flies and autopilot.landed:
        autopilot.body.idle()
        while autopilot.landed:
            yield


def become(autopilot: Autopilot, forward: bool | None) -> Iterator[None]:
    """Have a VTOL fly on its wing, or hover; None: what it is to do already. Nothing for any other type."""
    body = autopilot.body
    if autopilot.vehicle.type is not VehicleType.VTOL:
        return
    forward = body.flies_forward if forward is None else forward
    if body.flies_forward == forward and (not forward or has_become(autopilot, forward)):
        return
    body.transition_to(forward)
    if forward:
        autopilot.maneuvers.fly_on()  # circles begin when the wing carries it
    else:
        autopilot.maneuvers.hold()
    end = autopilot.now + _TRANSITION_LIMIT
    while autopilot.now < end and body.flies_forward == forward and not has_become(autopilot, forward):
        yield


def has_become(autopilot: Autopilot, forward: bool) -> bool:
    """Whether a transition is over."""
    done = autopilot.body.transition
    return done >= _ON_THE_WING if forward else done <= 1 - _ON_THE_WING


def go_there(autopilot: Autopilot, point: Point, *, radius: float | None = None) -> Iterator[None]:
    """Go to a point and wait until it is reached; a wing is then there, not at its altitude."""
    autopilot.maneuvers.go_to(point)
    while not autopilot.maneuvers.has_reached(point, radius):
        yield


def change_altitude(autopilot: Autopilot, point: Point) -> Iterator[None]:
    """Go up or down at a point: straight, or round in circles."""
    autopilot.maneuvers.hold(point)
    while not autopilot.maneuvers.is_at_altitude(point[2]):
        yield


class ClimbControl:
    """Thrust for a wanted climb of what hovers, for demands that take a thrust and no climb."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._body = autopilot.body
        self._hover = _HOVER

    def thrust(self, climb: float) -> float:
        """From 0 to 1; to be asked once a tick."""
        error = climb + self._body.estimate.velocity_down
        learnt = copysign(min(abs(error), 1.0), error) * _CLIMB_LEARNING
        self._hover = min(max(self._hover + learnt, 0.2), 0.8)
        return min(max(self._hover + error * _CLIMB_GAIN, 0.05), 1.0)
