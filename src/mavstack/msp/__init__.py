"""MSP, the MultiWii Serial Protocol of Betaflight and iNav, sans-IO: frames, messages, requests, settings."""

from mavstack.msp.firmware_info import FirmwareInfo
from mavstack.msp.frame import Direction, Frame, FrameVersion
from mavstack.msp.parser import FrameParser
from mavstack.msp.requests import Priority, Request, RequestEngine

__all__ = [
    "Direction",
    "FirmwareInfo",
    "Frame",
    "FrameParser",
    "FrameVersion",
    "Priority",
    "Request",
    "RequestEngine",
]
