"""The telemetry of a vehicle: typed messages, the latest of each, and values the same for every firmware."""

from mavstack.vehicle.telemetry.rates import Rates
from mavstack.vehicle.telemetry.stream import MessageStream
from mavstack.vehicle.telemetry.telemetry import Telemetry
from mavstack.vehicle.telemetry.value_stream import ValueStream
from mavstack.vehicle.telemetry.values import (
    Attitude,
    Battery,
    Engine,
    Esc,
    Generator,
    Gps,
    HomePosition,
    Imu,
    LocalPosition,
    Modem,
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
    "Engine",
    "Esc",
    "Generator",
    "Gps",
    "HomePosition",
    "Imu",
    "LocalPosition",
    "MessageStream",
    "Modem",
    "Odometry",
    "Position",
    "Rates",
    "Rc",
    "StatusText",
    "Telemetry",
    "ValueStream",
    "Velocity",
    "VfrHud",
    "Wind",
]
