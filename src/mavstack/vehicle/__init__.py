"""The application's API: `connect`, the vehicles that it finds, and what happens to them."""

from mavstack.services.heartbeat import OwnAddressConflict
from mavstack.vehicle.connection import Connection, NodeOptions, connect
from mavstack.vehicle.group import Group, Results
from mavstack.vehicle.vehicle import Vehicle
from mavstack.vehicle.vehicle_tracker import (
    GroundStationFound,
    GroundStationLost,
    GroundStationReturned,
    PayloadFound,
    PayloadLost,
    PayloadReturned,
    SecondAutopilotFound,
    SystemIdConflict,
    SystemIdConflictOver,
    VehicleEvent,
    VehicleFound,
    VehicleLost,
    VehicleRebooted,
    VehicleReturned,
)

__all__ = [
    "Connection",
    "GroundStationFound",
    "GroundStationLost",
    "GroundStationReturned",
    "Group",
    "NodeOptions",
    "OwnAddressConflict",
    "PayloadFound",
    "PayloadLost",
    "PayloadReturned",
    "Results",
    "SecondAutopilotFound",
    "SystemIdConflict",
    "SystemIdConflictOver",
    "Vehicle",
    "VehicleEvent",
    "VehicleFound",
    "VehicleLost",
    "VehicleRebooted",
    "VehicleReturned",
    "connect",
]
