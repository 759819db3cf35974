"""Handlers of the commands of ground stations, shared by all firmwares, in groups."""

from mavstack.sim.autopilot.command_positions import has_place, place_of
from mavstack.sim.autopilot.commands.arming import ArmingCommands
from mavstack.sim.autopilot.commands.equipment import EquipmentCommands
from mavstack.sim.autopilot.commands.home import HomeCommands, home_position
from mavstack.sim.autopilot.commands.imaging import CameraCommands, GimbalCommands
from mavstack.sim.autopilot.commands.maintenance import MaintenanceCommands
from mavstack.sim.autopilot.commands.missions import MissionCommands
from mavstack.sim.autopilot.commands.movement import MovementCommands
from mavstack.sim.autopilot.commands.registration import (
    CommandGroup,
    Handlers,
    Outcome,
    accept,
    number,
    register_handlers,
    waiting,
    whole,
)
from mavstack.sim.autopilot.refusal import CommandRefusedError
from mavstack.sim.autopilot.tasks import Tasks

__all__ = [
    "ArmingCommands",
    "CameraCommands",
    "CommandGroup",
    "CommandRefusedError",
    "EquipmentCommands",
    "GimbalCommands",
    "Handlers",
    "HomeCommands",
    "MaintenanceCommands",
    "MissionCommands",
    "MovementCommands",
    "Outcome",
    "Tasks",
    "accept",
    "has_place",
    "home_position",
    "number",
    "place_of",
    "register_handlers",
    "waiting",
    "whole",
]
