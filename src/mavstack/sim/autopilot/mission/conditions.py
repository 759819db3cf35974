"""The items that hold up what follows them until something is so."""

from __future__ import annotations

from math import copysign, pi, radians, remainder
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.mission.interfaces import Step

_HEADING_REACHED = radians(5)
#: A heading that is not reached by then is given up.
_PATIENCE = 60.0


def condition_delay(step: Step) -> Iterator[None]:
    """Param 1 seconds have passed."""
    end = step.now + step.number(1)
    while step.now < end:
        yield


def condition_distance(step: Step) -> Iterator[None]:
    """The next waypoint is no farther than param 1 metres."""
    yield  # until the vehicle is on its way there
    target = step.mission.course.point or step.autopilot.target
    while target is not None and step.maneuvers.distance(target) > step.number(1):
        yield
        target = step.mission.course.point or step.autopilot.target


def condition_yaw(step: Step) -> Iterator[None]:
    """The nose points to param 1 degrees, or by as many to the side of param 3 if param 4 is 1."""
    angle, here = radians(step.number(1)), step.autopilot.body.estimate.yaw
    if step.whole(4) == 1:
        angle = here + copysign(angle, step.number(3) or 1.0)
    if step.maneuvers.circles or step.autopilot.vehicle.type.on_surface:
        return
    step.maneuvers.yaw = angle
    step.mission.keep_course()
    end = step.now + _PATIENCE
    while (
        abs(remainder(step.autopilot.body.estimate.yaw - angle, 2 * pi)) > _HEADING_REACHED and step.now < end
    ):
        yield
