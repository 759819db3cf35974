"""Rovers and boats from steering and throttle: a bicycle on a plane, and a hull that drifts.

The speed follows the throttle with a lag. A rover turns by the angle of its wheels, so it turns only while it
moves; a boat by the water behind its propeller as well as by its speed, and it drifts in curves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.rotation import from_euler, rotate_back
from mavstack.simulators.state import GRAVITY, State

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Vector
    from mavstack.sim.vehicle_types import Home


@dataclass(frozen=True)
class SurfaceFacts:
    """The differences between a rover and a boat.

    Attributes:
        top_speed: Metres per second at full throttle.
        lag: Seconds in which the speed covers 63 % of a change.
        braking: The same when it slows down.
        turn: Turn rate at full steering in rad/s for each m/s of speed.
        top_turn: Greatest turn rate in rad/s.
        wash: Share of the throttle that turns a hull like speed does; 0 for wheels.
        drift: Seconds in which sideways motion falls to 37 %; 0: wheels hold.
    """

    top_speed: float
    lag: float
    braking: float
    turn: float
    top_turn: float
    wash: float = 0.0
    drift: float = 0.0


ROVER: Final = SurfaceFacts(top_speed=12.0, lag=0.6, braking=0.2, turn=0.9, top_turn=2.0)
BOAT: Final = SurfaceFacts(top_speed=4.0, lag=2.0, braking=1.2, turn=0.5, top_turn=1.0, wash=0.4, drift=0.8)


class Surface:
    """A rover or a boat.

    Args:
        facts: Its properties.
    """

    def __init__(self, facts: SurfaceFacts = ROVER) -> None:
        self._facts = facts
        self._position: Vector = (0.0, 0.0, 0.0)
        self._velocity: Vector = (0.0, 0.0, 0.0)
        self._yaw = self._speed = 0.0

    def reset(self, home: Home, heading: float) -> State:
        """Put it at home; see `Physics`."""
        self._position = self._velocity = (0.0, 0.0, 0.0)
        self._yaw, self._speed = math.radians(heading), 0.0
        return State(self._position, attitude=from_euler(0.0, 0.0, self._yaw))

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by steering (right is positive) and throttle, -1 to 1 each; see `Physics`."""
        steering, throttle = (max(-1.0, min(1.0, value)) for value in actuators[:2])
        facts = self._facts
        wanted = throttle * facts.top_speed
        lag = facts.braking if abs(wanted) < abs(self._speed) else facts.lag
        self._speed += (wanted - self._speed) * min(dt / lag, 1.0)
        by = self._speed + facts.wash * throttle * facts.top_speed
        rate = max(-facts.top_turn, min(facts.top_turn, steering * facts.turn * by))
        self._yaw += rate * dt
        cosine, sine = math.cos(self._yaw), math.sin(self._yaw)
        north, east, _ = self._velocity
        side = (-north * sine + east * cosine) * math.exp(-dt / facts.drift) if facts.drift else 0.0
        velocity = (self._speed * cosine - side * sine, self._speed * sine + side * cosine, 0.0)
        push = ((velocity[0] - north) / dt, (velocity[1] - east) / dt, -GRAVITY)
        self._velocity = velocity
        self._position = (self._position[0] + velocity[0] * dt, self._position[1] + velocity[1] * dt, 0.0)
        attitude = from_euler(0.0, 0.0, self._yaw)
        return State(self._position, velocity, attitude, (0.0, 0.0, rate), rotate_back(attitude, push))


def rover() -> Surface:
    """Return a rover with steered wheels."""
    return Surface(ROVER)


def boat() -> Surface:
    """Return a boat with a steered propeller."""
    return Surface(BOAT)
