"""Selection of the fence rules by firmware."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.fence.ardupilot import ArdupilotFenceRules
from mavstack.sim.autopilot.fence.px4 import Px4FenceRules
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.fence.rules import FenceRules


def fence_rules_of(autopilot: SimulatedAutopilot) -> FenceRules:
    """Return the fence rules of a vehicle."""
    ours = Px4FenceRules if autopilot.vehicle.firmware is Firmware.PX4 else ArdupilotFenceRules
    return ours(autopilot)
