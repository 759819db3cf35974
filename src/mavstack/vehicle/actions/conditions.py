"""Conditions that end an action only after they have held for a while."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle

#: A vehicle that stays armed on the ground for this time has landed, in seconds.
ARMED_LANDING_TIME: Final = 15.0


class SustainedCondition:
    """A condition that is met after it has held without a break for some seconds."""

    def __init__(self, vehicle: Vehicle, seconds: float) -> None:
        self._now = vehicle.connection.now
        self._seconds = seconds
        self._since: float | None = None

    def update(self, holds: bool) -> bool:
        """Take in whether the condition holds now; return whether it has held for long enough."""
        if not holds:
            self._since = None
            return False
        now = self._now()
        if self._since is None:
            self._since = now
        return now >= self._since + self._seconds


class Settled:
    """Detects that a value has changed by less than a span for some seconds."""

    def __init__(self, vehicle: Vehicle, seconds: float, span: float) -> None:
        self._now = vehicle.connection.now
        self._seconds, self._span = seconds, span
        self._anchor: tuple[float, float] | None = None

    def update(self, value: float | None) -> bool:
        """Take in the value, None to begin again; return whether it has settled."""
        if value is None:
            self._anchor = None
            return False
        now = self._now()
        if self._anchor is None or abs(value - self._anchor[0]) > self._span:
            self._anchor = value, now
        return now >= self._anchor[1] + self._seconds


class LandingDetector:
    """Detects that a vehicle has landed: it is disarmed, or it has been on the ground for a while."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._on_ground = SustainedCondition(vehicle, ARMED_LANDING_TIME)

    def has_landed(self) -> bool:
        """Return whether the vehicle has landed."""
        on_ground = self._on_ground.update(self._vehicle.landed_state == common.MavLandedState.ON_GROUND)
        return on_ground or self._vehicle.armed is False
