"""Vehicle motion without MAVLink: true motion, sensors, state estimate and inner control loops."""

from mavstack.geodesy import LocalFrame
from mavstack.sim.motion.body import Body
from mavstack.sim.motion.readings import (
    Aid,
    BatteryState,
    EstimateHealth,
    GpsReport,
    Limits,
    Motion,
    SensorReadings,
    Wind,
)
from mavstack.sim.motion.world import World

__all__ = [
    "Aid",
    "BatteryState",
    "Body",
    "EstimateHealth",
    "GpsReport",
    "Limits",
    "LocalFrame",
    "Motion",
    "SensorReadings",
    "Wind",
    "World",
]
