"""Telemetry of simulated vehicles: what each firmware sends by itself, and how often."""

from mavstack.sim.telemetry.ardupilot import provide_ardupilot
from mavstack.sim.telemetry.px4 import Link, provide_px4, use_link

__all__ = ["Link", "provide_ardupilot", "provide_px4", "use_link"]
