"""PX4's shell over SERIAL_CONTROL."""

from mavstack.sim.px4.shell.console import Console
from mavstack.sim.px4.shell.journal import Journal

__all__ = ["Console", "Journal"]
