"""PX4's shell over SERIAL_CONTROL."""

from mavstack.sim.px4.shell.console import Console
from mavstack.sim.px4.shell.message_log import MessageLog

__all__ = ["Console", "MessageLog"]
