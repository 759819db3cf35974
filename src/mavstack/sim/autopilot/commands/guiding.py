"""Effects of commands in flight: the target of guided flight, and changes of speed and yaw."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point


def guide_to(
    autopilot: SimulatedAutopilot,
    point: Point,
    *,
    speed: float | None = None,
    radius: float | None = None,
    yaw: float | None = None,
) -> None:
    """Go to a point in guided flight."""
    autopilot.guided.go_to(point, speed=speed, radius=radius, yaw=yaw)


def apply_choices(autopilot: SimulatedAutopilot) -> None:
    """Apply the chosen speed and yaw to the flight in progress."""
    if autopilot.mission.flying:
        autopilot.mission.keep_course()
    elif autopilot.behaviour is not None:
        autopilot.maneuvers.reissue()
