"""The senders of manual control: the latest input at a constant rate, and its release at the end.

A vehicle keeps the last input for a while when messages cease, so stopping releases it: channels are
released, sticks are declared absent and buttons released, several times, since nothing is acknowledged.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from mavstack.services.manual_control.inputs import RELEASE, ChannelOverride, ManualInput
from mavstack.services.stream_sender import StreamSender

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.addressing import Address

DEFAULT_RATE = 20.0
RELEASE_COUNT = 5
RELEASE_RATE = 10.0


class _ReleasingSender(StreamSender):
    """The base of senders that release their input before they stop."""

    def __init__(self, local: Address, target: Address, rate: float) -> None:
        super().__init__(local, target, rate)
        self._releases_left = 0
        self._normal_rate = self.rate

    @property
    def releasing(self) -> bool:
        """True while it sends releases, after which it stops."""
        return self._releases_left > 0

    def start(self, now: float, rate: float | None = None) -> None:
        self._releases_left = 0
        super().start(now, rate or self._normal_rate)
        self._normal_rate = self.rate

    def stop(self, now: float) -> None:
        """Release the input, then stop sending."""
        if self.active and not self.releasing:
            super().start(now, RELEASE_RATE)
            self._releases_left = RELEASE_COUNT

    def released(self, now: float) -> None:
        """Count one release."""
        self._releases_left -= 1
        if self._releases_left <= 0:
            super().stop(now)


class ManualControlSender(_ReleasingSender):
    """The sender of MANUAL_CONTROL to one system."""

    def __init__(self, local: Address, target: Address, rate: float = DEFAULT_RATE) -> None:
        super().__init__(local, target, rate)
        self.input = ManualInput()

    def set(self, sticks: ManualInput, now: float) -> None:
        """Send this input from the next tick on; starts with the first."""
        sticks.check()
        self.input = sticks
        if not self.active or self.releasing:
            self.start(now)

    def current_message(self, now: float) -> Message | None:
        if self.releasing:
            self.input = ManualInput()
            self.released(now)
        return self.input.to_message(self.target.system)


class OverrideSender(_ReleasingSender):
    """The sender of RC_CHANNELS_OVERRIDE to one component; channels that are no longer given are released."""

    def __init__(self, local: Address, target: Address, rate: float = DEFAULT_RATE) -> None:
        super().__init__(local, target, rate)
        self._channels: dict[int, int] = {}

    @property
    def override(self) -> ChannelOverride:
        """The channels that are sent now."""
        return ChannelOverride(MappingProxyType(dict(self._channels)))

    def set(self, override: ChannelOverride, now: float) -> None:
        """Override these channels from the next tick on; others that were overridden are released."""
        override.check()
        self._channels = dict.fromkeys(self._channels, RELEASE) | dict(override.channels)
        if not self.active or self.releasing:
            self.start(now)

    def current_message(self, now: float) -> Message | None:
        if self.releasing:
            self._channels = dict.fromkeys(self._channels, RELEASE)
            self.released(now)
        return self.override.to_message(self.target)
