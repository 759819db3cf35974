"""Failsafes: conditions that last too long, and the reactions."""

from mavstack.sim.autopilot.failsafes.conditions import ground_silence, radio_lost
from mavstack.sim.autopilot.failsafes.failsafe import Failsafe, nothing

__all__ = ["Failsafe", "ground_silence", "nothing", "radio_lost"]
