"""A disarmed plane in AUTO without a mission: it reports the end of the mission, and enters RTL.

An armed one does so as at the end of any mission (`mission.ardupilot`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


class EmptyMission:
    """One of the autopilot's periodic checks."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot

    def tick(self, now: float) -> None:
        """Leave AUTO if there is nothing to fly."""
        autopilot = self._autopilot
        mission, profile = autopilot.mission, autopilot.profile
        if not autopilot.armed and autopilot.mode.number == profile.mission and not mission.exists:
            text = "Mission complete, changing mode to RTL"
            autopilot.vehicle.send_statustext(text, common.MavSeverity.INFO)
            autopilot.enter(profile.return_to_launch, "mission end")
