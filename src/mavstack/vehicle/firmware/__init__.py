"""What firmwares want asked in different ways."""

from mavstack.vehicle.firmware.firmware import Firmware
from mavstack.vehicle.firmware.selection import firmware_of

__all__ = ["Firmware", "firmware_of"]
