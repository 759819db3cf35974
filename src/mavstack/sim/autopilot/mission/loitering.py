"""LOITER items: a wing circles, other vehicles hold the position or circle on demand."""

from __future__ import annotations

from math import copysign
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviours.orbit import Orbit
from mavstack.sim.autopilot.mission.navigation import leave_ground, use_default_flight_mode

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.autopilot.mission.rules import Step

_MAX_TURNS = 255.0


def loiter_forever(step: Step) -> Iterator[None]:
    """NAV_LOITER_UNLIM: stay until the mission is interrupted."""
    yield from _go_and_stay(step, step.place(), step.number(3))
    while True:
        step.mission.keep_course()
        yield


def loiter_for_a_time(step: Step) -> Iterator[None]:
    """NAV_LOITER_TIME: stay for param 1 seconds."""
    yield from _go_and_stay(step, step.place(), step.number(3))
    yield from step.wait(max(step.number(1), 0.0))
    step.mission.rules.waited(step)


def loiter_turns(step: Step) -> Iterator[None]:
    """NAV_LOITER_TURNS: circle param 1 times."""
    yield from leave_ground(step)
    yield from use_default_flight_mode(step)
    point, turns = step.place(), min(max(step.number(1), 0.0), _MAX_TURNS)
    step.mission.origin = point
    yield from step.behave(Orbit(step.autopilot, point, _radius(step, step.number(3)), turns=turns))


def loiter_to_altitude(step: Step) -> Iterator[None]:
    """NAV_LOITER_TO_ALT: fly there, then climb or descend."""
    yield from leave_ground(step)
    yield from use_default_flight_mode(step)
    north, east, down = step.place()
    if not step.maneuvers.circles:
        yield from step.travel((north, east, step.maneuvers.place[2]))
        yield from step.travel((north, east, down))
        return
    point, radius = (north, east, down), _radius(step, step.number(2))
    _circle(step, point, radius)
    while not (step.maneuvers.has_entered_circle(point, radius) and step.maneuvers.is_at_altitude(down)):
        yield


def _go_and_stay(step: Step, point: Point, radius: float) -> Iterator[None]:
    yield from leave_ground(step)
    yield from use_default_flight_mode(step)
    if not step.maneuvers.circles:
        yield from step.travel(point, yaw=step.yaw() if step.mission.rules.yaw_counts else None)
        return
    radius = _radius(step, radius)
    _circle(step, point, radius)
    while not step.maneuvers.has_entered_circle(point, radius):
        yield


def _circle(step: Step, point: Point, radius: float) -> None:
    step.mission.course.clear()
    step.mission.origin = point
    step.maneuvers.circle(point, radius)


def _radius(step: Step, wanted: float) -> float:
    """Return the radius; 0 and ±1 stand for the default radius, with their sign."""
    flight_parameters = step.autopilot.flight_parameters
    usual = flight_parameters.loiter_radius if step.maneuvers.circles else flight_parameters.circle_radius
    if abs(wanted) <= 1:
        return copysign(usual, wanted) if wanted else usual
    return wanted
