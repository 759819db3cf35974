"""Parameters of simulated vehicles."""

from mavstack.sim.parameters.metadata import metadata_files, served_metadata
from mavstack.sim.parameters.parameters import Parameters
from mavstack.sim.parameters.tables import definitions

__all__ = ["Parameters", "definitions", "metadata_files", "served_metadata"]
