"""Conditions of failsafes, measured alike for all firmwares."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


def ground_silence(autopilot: SimulatedAutopilot) -> float | None:
    """Return seconds since the last heartbeat of a ground station; None if there was none since the boot."""
    vehicle = autopilot.vehicle
    heard = [
        info.last_seen
        for info in vehicle.services.discovery.components.values()
        if info.type == common.MavType.GCS and vehicle.profile.is_ground(vehicle, info.address)
    ]
    return autopilot.now - max(heard) if heard else None


def radio_lost(autopilot: SimulatedAutopilot) -> bool:
    """Return whether the pilot's input was lost."""
    radio = autopilot.radio
    return radio.was_present and not radio.present
