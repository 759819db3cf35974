"""Helpers for motion tests: worlds, steps by the second, and recorded motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavstack.sim.motion import World
from mavstack.sim.vehicle_types import Home

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.motion import Body, Motion
    from mavstack.sim.vehicle_types import VehicleType

HOME = Home(47.4, 8.5, 488.0, 90.0)
Position = tuple[float, float, float]


def single_body(vehicle_type: VehicleType, *, wind: float = 0.0, seed: int = 1) -> tuple[World, Body]:
    """Return a world with one body, and wind in m/s from the west with gusts."""
    world = World(seed=seed)
    world.set_wind(wind, 270.0, 0.2)
    return world, world.add(vehicle_type, HOME)


def several_bodies(vehicle_type: VehicleType, count: int, *, wind: float = 0.0) -> tuple[World, list[Body]]:
    """Return a world with several bodies of one type."""
    world = World(seed=1)
    world.set_wind(wind, 270.0, 0.2)
    return world, [world.add(vehicle_type, HOME) for _ in range(count)]


def step_for(world: World, seconds: float, until: Callable[[], bool] | None = None) -> float:
    """Step for some seconds or until a condition holds; return the seconds it took."""
    begin = world.time
    for _ in range(round(seconds * world.rate)):
        world.step()
        if until is not None and until():
            break
    return world.time - begin


def record(world: World, body: Body, seconds: float) -> list[Motion]:
    """Step for some seconds; return the true motion of every step."""
    return record_all(world, [body], seconds)[0]


def record_all(world: World, bodies: list[Body], seconds: float) -> list[list[Motion]]:
    """Step for some seconds; return each body's true motion of every step."""
    motions: list[list[Motion]] = [[] for _ in bodies]
    for _ in range(round(seconds * world.rate)):
        world.step()
        for motion_list, body in zip(motions, bodies, strict=True):
            motion_list.append(body.truth)
    return motions


def horizontal_distance(motion: Motion, north: float, east: float) -> float:
    """Return the horizontal distance to a point."""
    return math.hypot(motion.north - north, motion.east - east)


def distance_to(motion: Motion, place: Position) -> float:
    """Return the distance to a point."""
    return math.dist(motion[:3], place)


def speed(motion: Motion) -> float:
    """Return the speed in m/s."""
    return math.hypot(motion.velocity_north, motion.velocity_east, motion.velocity_down)


def absolute_angle(angle: float) -> float:
    """Return the magnitude of an angle within one turn."""
    return abs(math.remainder(angle, math.tau))
