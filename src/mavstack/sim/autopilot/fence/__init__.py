"""Geofences: shapes, limits from parameters, and the reaction to a breach."""

from mavstack.sim.autopilot.fence.watch import FenceWatch
from mavstack.sim.autopilot.fence_shapes import Circle, Fence, Polygon

__all__ = ["Circle", "Fence", "FenceWatch", "Polygon"]
