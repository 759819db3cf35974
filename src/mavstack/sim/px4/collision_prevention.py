"""PX4's collision prevention: a copter that a pilot flies in Position mode stops CP_DIST before obstacles.

Missions, Hold, Return and Offboard do not use it, as in PX4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.px4.modes import POSITION

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


def collision_margin(autopilot: SimulatedAutopilot) -> float | None:
    """Return the metres to keep from obstacles; None if CP_DIST is negative or another mode is flown."""
    margin = float(autopilot.vehicle.parameters.get("CP_DIST", -1.0))
    return margin if margin >= 0 and autopilot.mode.number == POSITION else None
