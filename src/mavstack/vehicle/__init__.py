"""The application's API: `connect`, the vehicles that it finds, and what happens to them."""

from mavstack.services.heartbeat import AddressTaken
from mavstack.vehicle.connection import Connection, NodeOptions, connect
from mavstack.vehicle.group import Group, Results
from mavstack.vehicle.life import (
    GroundStationFound,
    GroundStationLost,
    GroundStationReturned,
    PayloadFound,
    PayloadLost,
    PayloadReturned,
    SecondAutopilotFound,
    SystemIdClash,
    SystemIdClashOver,
    VehicleEvent,
    VehicleFound,
    VehicleLost,
    VehicleRebooted,
    VehicleReturned,
)
from mavstack.vehicle.vehicle import Vehicle

__all__ = [
    "AddressTaken",
    "Connection",
    "GroundStationFound",
    "GroundStationLost",
    "GroundStationReturned",
    "Group",
    "NodeOptions",
    "PayloadFound",
    "PayloadLost",
    "PayloadReturned",
    "Results",
    "SecondAutopilotFound",
    "SystemIdClash",
    "SystemIdClashOver",
    "Vehicle",
    "VehicleEvent",
    "VehicleFound",
    "VehicleLost",
    "VehicleRebooted",
    "VehicleReturned",
    "connect",
]
