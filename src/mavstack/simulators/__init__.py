"""Simulators: Mavstack as the world in which real firmware flies, and its vehicles in other worlds.

    physics (motion) -> sensors (errors, faults) -> interface of a firmware -> its outputs -> physics

`Px4Interface`, `JsonInterface` and `BetaflightInterface` are the conversations with the firmwares, sans-IO;
the simulators put them behind sockets. `Physics` is what a user's own body implements.
"""

from mavstack.simulators.ardupilot_simulator import ArduPilotSimulator
from mavstack.simulators.betaflight_simulator import BetaflightSimulator
from mavstack.simulators.faults import FAULTS
from mavstack.simulators.firmware_session import FirmwareOptions, FirmwareSession
from mavstack.simulators.hardware_simulator import HardwareSimulator
from mavstack.simulators.physics import PHYSICS, Physics, load_physics
from mavstack.simulators.px4_simulator import Px4Simulator
from mavstack.simulators.sensor_model import SensorModel, SensorModels
from mavstack.simulators.sensors import Sensors
from mavstack.simulators.simulator import Simulator
from mavstack.simulators.state import State

__all__ = [
    "FAULTS",
    "PHYSICS",
    "ArduPilotSimulator",
    "BetaflightSimulator",
    "FirmwareOptions",
    "FirmwareSession",
    "HardwareSimulator",
    "Physics",
    "Px4Simulator",
    "SensorModel",
    "SensorModels",
    "Sensors",
    "Simulator",
    "State",
    "load_physics",
]
