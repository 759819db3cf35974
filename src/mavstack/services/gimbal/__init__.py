"""The gimbal manager protocol v2: discovery, control, pointing and streams; client and server."""

from mavstack.services.gimbal.aim import RegionOfInterest, SystemOfInterest, VehiclePose, direction_to
from mavstack.services.gimbal.control import GimbalControl
from mavstack.services.gimbal.monitor import GimbalFound, GimbalMonitor, GimbalStatusChanged
from mavstack.services.gimbal.motion import GimbalMotion
from mavstack.services.gimbal.operations import (
    ListGimbals,
    PointGimbal,
    TakeControl,
    assign_control,
    release_control,
)
from mavstack.services.gimbal.reports import GimbalAttitude, GimbalInformation, GimbalStatus
from mavstack.services.gimbal.rotation import angles_of, quaternion_of
from mavstack.services.gimbal.server import GimbalControlChanged, GimbalDevice, GimbalManagerServer, GimbalSet
from mavstack.services.gimbal.setpoint import GimbalSetpoint, GimbalSticks, GimbalValue
from mavstack.services.gimbal.streamer import GimbalStreamer

__all__ = [
    "GimbalAttitude",
    "GimbalControl",
    "GimbalControlChanged",
    "GimbalDevice",
    "GimbalFound",
    "GimbalInformation",
    "GimbalManagerServer",
    "GimbalMonitor",
    "GimbalMotion",
    "GimbalSet",
    "GimbalSetpoint",
    "GimbalStatus",
    "GimbalStatusChanged",
    "GimbalSticks",
    "GimbalStreamer",
    "GimbalValue",
    "ListGimbals",
    "PointGimbal",
    "RegionOfInterest",
    "SystemOfInterest",
    "TakeControl",
    "VehiclePose",
    "angles_of",
    "assign_control",
    "direction_to",
    "quaternion_of",
    "release_control",
]
