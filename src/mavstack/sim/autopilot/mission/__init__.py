"""Missions: their items, their order, and the rules of each firmware."""

from mavstack.sim.autopilot.mission.runner import MissionRunner

__all__ = ["MissionRunner"]
