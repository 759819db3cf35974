"""What firmwares want asked in different ways."""

from mavstack.vehicle.firmware.choosing import firmware_of
from mavstack.vehicle.firmware.firmware import Firmware

__all__ = ["Firmware", "firmware_of"]
