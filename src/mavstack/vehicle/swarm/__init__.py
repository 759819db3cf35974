"""Swarms: several vehicles that fly as one; `mavstack.swarm` has the planning."""

from mavstack.vehicle.swarm.controller import SwarmOptions
from mavstack.vehicle.swarm.swarm import Swarm

__all__ = ["Swarm", "SwarmOptions"]
