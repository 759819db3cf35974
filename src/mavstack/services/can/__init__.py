"""CAN over MAVLink: frames, and the autopilot's side that forwards its buses."""

from mavstack.services.can.frames import CanFrame, from_message, to_message
from mavstack.services.can.server import CanFrameReceived, CanServer

__all__ = ["CanFrame", "CanFrameReceived", "CanServer", "from_message", "to_message"]
