"""Heartbeats: saying that we are here, and knowing who else is (guide: heartbeat/connection protocol)."""

from mavstack.services.heartbeat.beacon import Beacon
from mavstack.services.heartbeat.claims import Claim
from mavstack.services.heartbeat.discovery import (
    AddressClash,
    AddressClashOver,
    OwnAddressConflict,
    ComponentChanged,
    ComponentFound,
    ComponentInfo,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    Discovery,
)
from mavstack.services.heartbeat.kinds import describe_kind

__all__ = [
    "AddressClash",
    "AddressClashOver",
    "OwnAddressConflict",
    "Beacon",
    "Claim",
    "ComponentChanged",
    "ComponentFound",
    "ComponentInfo",
    "ComponentLost",
    "ComponentRebooted",
    "ComponentReturned",
    "Discovery",
    "describe_kind",
]
