"""Missions: the items, in which order they are flown, and what each firmware makes of them."""

from mavstack.sim.autopilot.mission.runner import MissionRunner

__all__ = ["MissionRunner"]
