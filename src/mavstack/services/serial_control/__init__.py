"""A shell or a serial port over the link: SERIAL_CONTROL, as PX4's nsh uses it."""

from mavstack.services.serial_control.client import ShellClient, ShellOutput, ShellReleased
from mavstack.services.serial_control.server import ShellClosed, ShellInput, ShellOpened, ShellServer

__all__ = [
    "ShellClient",
    "ShellClosed",
    "ShellInput",
    "ShellOpened",
    "ShellOutput",
    "ShellReleased",
    "ShellServer",
]
