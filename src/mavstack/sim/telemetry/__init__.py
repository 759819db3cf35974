"""Telemetry of simulated vehicles: the messages that each firmware streams, and their rates."""

from mavstack.sim.telemetry.ardupilot import publish_ardupilot
from mavstack.sim.telemetry.high_latency import HighLatency
from mavstack.sim.telemetry.px4 import LinkMode, publish_px4, set_link_mode

__all__ = ["HighLatency", "LinkMode", "publish_ardupilot", "publish_px4", "set_link_mode"]
