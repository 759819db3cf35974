"""What a vehicle tells: typed messages, the latest of each, and values the same of every firmware."""

from mavstack.vehicle.telemetry.properties import TelemetryProperties
from mavstack.vehicle.telemetry.rates import Rates
from mavstack.vehicle.telemetry.stream import Stream
from mavstack.vehicle.telemetry.telemetry import Telemetry
from mavstack.vehicle.telemetry.values import (
    Attitude,
    Battery,
    Gps,
    HomePosition,
    Imu,
    LocalPosition,
    Odometry,
    Position,
    Rc,
    StatusText,
    Velocity,
    VfrHud,
    Wind,
)

__all__ = [
    "Attitude",
    "Battery",
    "Gps",
    "HomePosition",
    "Imu",
    "LocalPosition",
    "Odometry",
    "Position",
    "Rates",
    "Rc",
    "StatusText",
    "Stream",
    "Telemetry",
    "TelemetryProperties",
    "Velocity",
    "VfrHud",
    "Wind",
]
