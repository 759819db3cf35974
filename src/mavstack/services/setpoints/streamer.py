"""Sending setpoints: the newest one, at a kept rate, for as long as the vehicle is to follow.

PX4 enters its offboard mode only after it has heard setpoints for a while, at more than two a second, and
leaves it when they cease; ArduPilot stops after a few seconds of silence. So one setpoint is repeated until
the next one replaces it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.stream_sender import StreamSender

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.setpoints.setpoint import Setpoint

RATE = 20.0


class SetpointStreamer(StreamSender):
    """Streams setpoints to one vehicle."""

    def __init__(self, local: Address, target: Address, rate: float = RATE) -> None:
        super().__init__(local, target, rate)
        self.setpoint: Setpoint | None = None
        self._booted_at: float | None = None

    def set(self, setpoint: Setpoint, now: float) -> None:
        """Send this setpoint from the next beat on, and begin if it is the first."""
        setpoint.check()
        self.setpoint = setpoint
        if not self.active:
            self.start(now)

    def current_message(self, now: float) -> Message | None:
        if self.setpoint is None:
            return None
        self._booted_at = now if self._booted_at is None else self._booted_at
        milliseconds = round((now - self._booted_at) * 1000) & 0xFFFFFFFF
        return self.setpoint.to_message(self.target, milliseconds)
