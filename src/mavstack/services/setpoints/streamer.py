"""The sender of setpoints: the latest one, at a constant rate, for as long as the vehicle shall follow.

PX4 enters its offboard mode only after it has received setpoints for a while, at more than two per second,
and leaves it when they cease; ArduPilot stops after a few seconds of silence. So one setpoint is repeated
until the next one replaces it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.stream_sender import StreamSender

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.setpoints.setpoint import Setpoint

DEFAULT_RATE = 20.0


class SetpointStreamer(StreamSender):
    """The sender of setpoints to one vehicle, at `rate` hertz."""

    def __init__(self, local: Address, target: Address, rate: float = DEFAULT_RATE) -> None:
        super().__init__(local, target, rate)
        self.setpoint: Setpoint | None = None
        self._booted_at: float | None = None

    def set(self, setpoint: Setpoint, now: float) -> None:
        """Send this setpoint from the next tick on; starts with the first.

        Raises:
            SetpointError: No vehicle can follow the setpoint.
        """
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
