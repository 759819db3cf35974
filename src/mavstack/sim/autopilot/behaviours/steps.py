"""Parts of scripts that several behaviours share; each is a generator for `yield from`."""

from __future__ import annotations

from math import copysign
from typing import TYPE_CHECKING

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

#: Maximum time to wait for a transition, in seconds.
_TRANSITION_LIMIT = 40.0
_ON_THE_WING = 0.95
#: Throttle for each m/s of climb error, and the change of the learned hover throttle for each m/s and tick.
_CLIMB_GAIN, _CLIMB_LEARNING = 0.1, 0.01
_HOVER = 0.5


def wait(autopilot: SimulatedAutopilot, seconds: float) -> Iterator[None]:
    """Wait for some seconds."""
    end = autopilot.now + seconds
    while autopilot.now < end:
        yield


def idle_on_ground(autopilot: SimulatedAutopilot) -> Iterator[None]:
    """Idle while an aircraft is on the ground."""
    if autopilot.vehicle.vehicle_type.flies and autopilot.landed:
        autopilot.body.idle()
        while autopilot.landed:
            yield


def transition(autopilot: SimulatedAutopilot, forward: bool | None) -> Iterator[None]:
    """Make a VTOL fly forward or hover; None keeps its flight mode. No effect on other types."""
    body = autopilot.body
    if autopilot.vehicle.vehicle_type is not VehicleType.VTOL:
        return
    forward = body.flies_forward if forward is None else forward
    if body.flies_forward == forward and (not forward or transition_complete(autopilot, forward)):
        return
    body.transition_to(forward)
    if forward:
        # Fly straight ahead: the vehicle can circle only when the wing carries it
        autopilot.maneuvers.fly_on()
    else:
        autopilot.maneuvers.hold()
    end = autopilot.now + _TRANSITION_LIMIT
    while (
        autopilot.now < end and body.flies_forward == forward and not transition_complete(autopilot, forward)
    ):
        yield


def transition_complete(autopilot: SimulatedAutopilot, forward: bool) -> bool:
    """Return whether a transition is complete."""
    done = autopilot.body.transition
    return done >= _ON_THE_WING if forward else done <= 1 - _ON_THE_WING


def fly_to(autopilot: SimulatedAutopilot, point: Point, *, radius: float | None = None) -> Iterator[None]:
    """Go to a point and wait until it is reached; a wing may be at another altitude."""
    autopilot.maneuvers.go_to(point)
    while not autopilot.maneuvers.has_reached(point, radius):
        yield


def change_altitude(autopilot: SimulatedAutopilot, point: Point) -> Iterator[None]:
    """Climb or descend at a point: vertically, or in circles."""
    autopilot.maneuvers.hold(point)
    while not autopilot.maneuvers.is_at_altitude(point[2]):
        yield


class ClimbControl:
    """Thrust for a climb rate of a hovering vehicle, for demands without a climb rate."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._body = autopilot.body
        self._hover = _HOVER

    def thrust(self, climb: float) -> float:
        """Return the thrust from 0 to 1; call once per tick."""
        error = climb + self._body.estimate.velocity_down
        learnt = copysign(min(abs(error), 1.0), error) * _CLIMB_LEARNING
        self._hover = min(max(self._hover + learnt, 0.2), 0.8)
        return min(max(self._hover + error * _CLIMB_GAIN, 0.05), 1.0)
