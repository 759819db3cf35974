"""The sender of gimbal setpoints or stick positions: the newest one, at a constant rate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.gimbal.reports import ALL_DEVICES
from mavstack.services.stream_sender import StreamSender

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.gimbal.setpoint import GimbalValue

DEFAULT_RATE = 20.0


class GimbalStreamer(StreamSender):
    """The sender of setpoints to one gimbal, at `rate` hertz."""

    def __init__(
        self, local: Address, target: Address, rate: float = DEFAULT_RATE, device_id: int = ALL_DEVICES
    ) -> None:
        super().__init__(local, target, rate)
        self.device_id = device_id
        self.value: GimbalValue | None = None

    def set(self, value: GimbalValue, now: float) -> None:
        """Send this value from the next tick on; starts with the first.

        Raises:
            InvalidTypeError: A field is not a number.
            InvalidArgumentError: A field is out of range.
        """
        value.check()
        self.value = value
        if not self.active:
            self.start(now)

    def current_message(self, now: float) -> Message | None:
        return None if self.value is None else self.value.to_message(self.target, self.device_id)
