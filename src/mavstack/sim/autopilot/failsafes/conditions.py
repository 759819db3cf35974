"""What can go wrong, measured the same way for every firmware."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Autopilot


def ground_silence(autopilot: Autopilot) -> float | None:
    """Seconds since a ground station's last heartbeat; None if there never was one since the start."""
    vehicle = autopilot.vehicle
    heard = [
        info.last_seen
        for info in vehicle.services.discovery.components.values()
        if info.type == common.MavType.GCS and vehicle.profile.is_ground(vehicle, info.address)
    ]
    return autopilot.now - max(heard) if heard else None


def radio_lost(autopilot: Autopilot) -> bool:
    """Whether there were a pilot's hands, and there are none now."""
    radio = autopilot.radio
    return radio.was_present and not radio.present
