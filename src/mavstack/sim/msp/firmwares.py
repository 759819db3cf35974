"""The firmwares of simulated flight controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.msp.betaflight import Betaflight
from mavstack.sim.msp.inav import Inav
from mavstack.sim.vehicle_types import ControllerFirmware

if TYPE_CHECKING:
    from mavstack.sim.msp.controller import SimulatedFlightController
    from mavstack.sim.msp.system import System


def start_firmware(firmware: ControllerFirmware, host: SimulatedFlightController, eeprom: bytes) -> System:
    """Return a firmware that has just booted."""
    kind = Inav if firmware is ControllerFirmware.INAV else Betaflight
    return kind(host, eeprom)
