"""Simulated devices on the CAN bus of a vehicle."""

from mavstack.sim.can.devices import CanDevices
from mavstack.sim.can.dronecan import DroneCanNode, TransferReceiver, transfer_frames

__all__ = ["CanDevices", "DroneCanNode", "TransferReceiver", "transfer_frames"]
