"""Geofences: their shapes, the limits that parameters set, and what is done about a breach."""

from mavstack.sim.autopilot.fence.geometry import Circle, Fence, Polygon
from mavstack.sim.autopilot.fence.watch import FenceWatch

__all__ = ["Circle", "Fence", "FenceWatch", "Polygon"]
