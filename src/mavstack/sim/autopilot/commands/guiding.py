"""What commands change in flight: where the guided mode goes, and how what is flown now is flown."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.autopilot.maneuvers import Point


def guide_to(
    autopilot: Autopilot,
    point: Point,
    *,
    speed: float | None = None,
    radius: float | None = None,
    yaw: float | None = None,
) -> None:
    """Go to a point, in the guided mode."""
    autopilot.guided.go_to(point, speed=speed, radius=radius, yaw=yaw)


def fly_as_chosen(autopilot: Autopilot) -> None:
    """Have the speed and yaw that were just chosen count for what is flown now."""
    if autopilot.mission.flying:
        autopilot.mission.keep_course()
    elif autopilot.behaviour is not None:
        autopilot.maneuvers.reissue()
