"""The application's API: `connect`, and the vehicles that it finds."""

from mavstack.vehicle.connection import Connection, connect
from mavstack.vehicle.vehicle import Vehicle

__all__ = ["Connection", "Vehicle", "connect"]
