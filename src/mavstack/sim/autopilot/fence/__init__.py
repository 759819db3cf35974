"""Geofences: shapes, limits from parameters, and the reaction to a breach."""

from mavstack.sim.autopilot.fence.geometry import Circle, Fence, Polygon
from mavstack.sim.autopilot.fence.watch import FenceWatch

__all__ = ["Circle", "Fence", "FenceWatch", "Polygon"]
