"""The payloads of simulated vehicles: a camera component and a gimbal."""

from mavstack.sim.payloads.camera import CAMERA_COMPONENT, SimulatedCamera
from mavstack.sim.payloads.gimbal import SimulatedGimbal

__all__ = ["CAMERA_COMPONENT", "SimulatedCamera", "SimulatedGimbal"]
