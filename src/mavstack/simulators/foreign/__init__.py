"""Vehicles of Mavstack in the worlds of other simulators."""

from mavstack.simulators.foreign.foreign_vehicle import ForeignVehicle

__all__ = ["ForeignVehicle"]
