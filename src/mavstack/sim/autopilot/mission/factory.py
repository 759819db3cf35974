"""Selection of the mission rules by firmware."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.mission.ardupilot import ArdupilotMissionRules
from mavstack.sim.autopilot.mission.px4 import Px4MissionRules
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.mission.rules import MissionRules


def rules_of(autopilot: SimulatedAutopilot) -> MissionRules:
    """Return the mission rules of a vehicle."""
    ours = Px4MissionRules if autopilot.vehicle.firmware is Firmware.PX4 else ArdupilotMissionRules
    return ours(autopilot)
