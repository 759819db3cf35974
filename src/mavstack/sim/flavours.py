"""Which flavour a firmware has on a type of vehicle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.ardupilot import ArdupilotFlavour
from mavstack.sim.kinds import Firmware
from mavstack.sim.px4 import Px4Flavour

if TYPE_CHECKING:
    from mavstack.sim.autopilot.flavour import Flavour
    from mavstack.sim.kinds import VehicleType


def flavour_of(firmware: Firmware, type: VehicleType) -> Flavour:  # noqa: A002 (HEARTBEAT's name for it)
    """The flavour of one vehicle."""
    return Px4Flavour(type) if firmware is Firmware.PX4 else ArdupilotFlavour(type)
