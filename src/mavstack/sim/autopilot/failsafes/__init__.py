"""Failsafes: what goes wrong for long enough, and what is done about it."""

from mavstack.sim.autopilot.failsafes.conditions import (
    ground_silence,
    radio_lost,
)
from mavstack.sim.autopilot.failsafes.failsafe import Failsafe, nothing

__all__ = ["Failsafe", "ground_silence", "nothing", "radio_lost"]
