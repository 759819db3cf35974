"""Firmware differences: one class for each firmware holds its facts and the way it wants its commands."""

from mavstack.vehicle.firmware.ardupilot import ArduPilot
from mavstack.vehicle.firmware.firmware import Firmware
from mavstack.vehicle.firmware.msp import Betaflight, Inav, MspFirmware
from mavstack.vehicle.firmware.px4 import Px4
from mavstack.vehicle.firmware.selection import firmware_class, firmware_of

__all__ = [
    "ArduPilot",
    "Betaflight",
    "Firmware",
    "Inav",
    "MspFirmware",
    "Px4",
    "firmware_class",
    "firmware_of",
]
