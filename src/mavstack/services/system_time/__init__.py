"""SYSTEM_TIME: the clocks of components, and their reboots."""

from mavstack.services.system_time.broadcaster import SystemTimeBroadcaster
from mavstack.services.system_time.observer import Rebooted, SystemClock, SystemTimeObserver, UnixTimeKnown
from mavstack.services.system_time.reboot import RebootDetector

__all__ = [
    "RebootDetector",
    "Rebooted",
    "SystemClock",
    "SystemTimeBroadcaster",
    "SystemTimeObserver",
    "UnixTimeKnown",
]
