"""Data of a companion computer for a vehicle's estimator and its avoidance."""

from mavstack.vehicle.external.diagnosis import ExternalStatus
from mavstack.vehicle.external.external import External

__all__ = ["External", "ExternalStatus"]
