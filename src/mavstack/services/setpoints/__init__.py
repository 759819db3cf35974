"""Setpoints for offboard and guided modes (guide: offboard control interface)."""

from mavstack.services.setpoints.receiver import SetpointReceived, SetpointReceiver, SetpointsTimedOut
from mavstack.services.setpoints.setpoint import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint, Setpoint
from mavstack.services.setpoints.streamer import SetpointStreamer

__all__ = [
    "AttitudeSetpoint",
    "GlobalSetpoint",
    "LocalSetpoint",
    "Setpoint",
    "SetpointReceived",
    "SetpointReceiver",
    "SetpointStreamer",
    "SetpointsTimedOut",
]
