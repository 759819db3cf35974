"""Messages by which a companion computer tells an autopilot where it is, and what is around it."""

from mavstack.services.external.estimates import PoseEstimate
from mavstack.services.external.frames import Frame
from mavstack.services.external.monitor import StreamMonitor
from mavstack.services.external.surroundings import distance_message, obstacle_message, scan_sectors
from mavstack.services.external.targets import follow_message, landing_angles, landing_message

__all__ = [
    "Frame",
    "PoseEstimate",
    "StreamMonitor",
    "distance_message",
    "follow_message",
    "landing_angles",
    "landing_message",
    "obstacle_message",
    "scan_sectors",
]
