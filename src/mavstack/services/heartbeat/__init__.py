"""Heartbeats: saying that we are here, and knowing who else is (guide: heartbeat/connection protocol)."""

from mavstack.services.heartbeat.beacon import Beacon
from mavstack.services.heartbeat.discovery import (
    ComponentFound,
    ComponentInfo,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    Discovery,
)

__all__ = [
    "Beacon",
    "ComponentFound",
    "ComponentInfo",
    "ComponentLost",
    "ComponentRebooted",
    "ComponentReturned",
    "Discovery",
]
