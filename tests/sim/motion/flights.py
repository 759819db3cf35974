"""Flying bodies in tests: a home, steps by the second, and what was seen on the way."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavstack.sim.motion import World
from mavstack.sim.vehicle_types import Home

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.motion import Body, Motion
    from mavstack.sim.vehicle_types import VehicleType

DEFAULT_HOME = Home(47.4, 8.5, 488.0, 90.0)
Place = tuple[float, float, float]


def alone(kind: VehicleType, *, wind: float = 0.0, seed: int = 1) -> tuple[World, Body]:
    """A world with one body, and wind from the west with gusts."""
    world = World(seed=seed)
    world.set_wind(wind, 270.0, 0.2)
    return world, world.add(kind, DEFAULT_HOME)


def together(kind: VehicleType, count: int, *, wind: float = 0.0) -> tuple[World, list[Body]]:
    """A world with several bodies of a type."""
    world = World(seed=1)
    world.set_wind(wind, 270.0, 0.2)
    return world, [world.add(kind, DEFAULT_HOME) for _ in range(count)]


def fly(world: World, seconds: float, until: Callable[[], bool] | None = None) -> float:
    """Step for some seconds, or until something is so; give how long it took."""
    begin = world.time
    for _ in range(round(seconds * world.rate)):
        world.step()
        if until is not None and until():
            break
    return world.time - begin


def watch(world: World, body: Body, seconds: float) -> list[Motion]:
    """Step for some seconds; give the truth of every step."""
    return watch_all(world, [body], seconds)[0]


def watch_all(world: World, bodies: list[Body], seconds: float) -> list[list[Motion]]:
    """Step for some seconds; give each body's truth of every step."""
    seen: list[list[Motion]] = [[] for _ in bodies]
    for _ in range(round(seconds * world.rate)):
        world.step()
        for own, body in zip(seen, bodies, strict=True):
            own.append(body.truth)
    return seen


def away(motion: Motion, north: float, east: float) -> float:
    """Horizontal distance from a point."""
    return math.hypot(motion.north - north, motion.east - east)


def apart(motion: Motion, place: Place) -> float:
    """Distance from a point."""
    return math.dist(motion[:3], place)


def speed(motion: Motion) -> float:
    """How fast it moves."""
    return math.hypot(motion.velocity_north, motion.velocity_east, motion.velocity_down)


def turned(angle: float) -> float:
    """An angle within a turn, without its sign."""
    return abs(math.remainder(angle, math.tau))
