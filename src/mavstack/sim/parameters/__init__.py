"""Parameters of simulated vehicles."""

from mavstack.sim.parameters.parameters import Parameters
from mavstack.sim.parameters.tables import definitions

__all__ = ["Parameters", "definitions"]
