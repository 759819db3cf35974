"""CONDITION items: they delay the following items until a condition is met."""

from __future__ import annotations

from math import copysign, pi, radians, remainder
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.mission.rules import Step

_HEADING_REACHED = radians(5)
#: Seconds after which CONDITION_YAW ends even if the heading is not reached.
_YAW_TIMEOUT = 60.0


def condition_delay(step: Step) -> Iterator[None]:
    """CONDITION_DELAY: wait for param 1 seconds."""
    end = step.now + step.number(1)
    while step.now < end:
        yield


def condition_distance(step: Step) -> Iterator[None]:
    """CONDITION_DISTANCE: wait until the next waypoint is within param 1 metres."""
    yield  # wait one tick until the line to the next waypoint is set
    target = step.mission.course.point or step.autopilot.target
    while target is not None and step.maneuvers.distance(target) > step.number(1):
        yield
        target = step.mission.course.point or step.autopilot.target


def condition_yaw(step: Step) -> Iterator[None]:
    """CONDITION_YAW: turn to param 1 degrees; relative, in the direction of param 3, if param 4 is 1."""
    angle, here = radians(step.number(1)), step.autopilot.body.estimate.yaw
    if step.whole(4) == 1:
        angle = here + copysign(angle, step.number(3) or 1.0)
    if step.maneuvers.circles or step.autopilot.vehicle.vehicle_type.on_surface:
        return
    step.maneuvers.yaw = angle
    step.mission.keep_course()
    end = step.now + _YAW_TIMEOUT
    while (
        abs(remainder(step.autopilot.body.estimate.yaw - angle, 2 * pi)) > _HEADING_REACHED and step.now < end
    ):
        yield
