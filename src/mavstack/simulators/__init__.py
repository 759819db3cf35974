"""Simulators: Mavstack as the world in which real firmware flies.

    physics (motion) -> sensors (noise, faults) -> interface of a firmware -> its outputs -> physics

`Px4Interface` and `JsonInterface` are the conversations with PX4 and ArduPilot, sans-IO; `Px4Simulator` and
`ArduPilotSimulator` put them behind sockets. `Physics` is what a user's own body implements.
"""

from mavstack.simulators.physics import PHYSICS, Physics, load_physics
from mavstack.simulators.sensors import FAULTS, Sensors
from mavstack.simulators.simulator import ArduPilotSimulator, Px4Simulator
from mavstack.simulators.state import State

__all__ = [
    "FAULTS",
    "PHYSICS",
    "ArduPilotSimulator",
    "Physics",
    "Px4Simulator",
    "Sensors",
    "State",
    "load_physics",
]
