"""Everybody's clock (SYSTEM_TIME), and whether a component started anew."""

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
