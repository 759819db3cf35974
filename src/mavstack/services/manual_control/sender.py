"""Steering by hand over the link: the newest input at a kept rate, and hands off when it stops.

A vehicle that hears nothing more holds the last input for a while, so stopping says it: channels are given
back, sticks are declared absent and buttons let go, several times, since nobody acknowledges.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from mavstack.services.manual_control.inputs import RELEASE, ChannelOverride, ManualInput
from mavstack.services.stream_sender import StreamSender

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.addressing import Address

RATE = 20.0
RELEASES = 5
RELEASE_RATE = 10.0


class _HandSender(StreamSender):
    """A sender that lets go before it falls silent."""

    def __init__(self, local: Address, target: Address, rate: float) -> None:
        super().__init__(local, target, rate)
        self._releases_left = 0
        self._usual_rate = self.rate

    @property
    def releasing(self) -> bool:
        """Whether it is letting go; when that is done it is silent."""
        return self._releases_left > 0

    def start(self, now: float, rate: float | None = None) -> None:
        self._releases_left = 0
        super().start(now, rate or self._usual_rate)
        self._usual_rate = self.rate

    def stop(self, now: float) -> None:
        """Let go, then send nothing more."""
        if self.active and not self.releasing:
            super().start(now, RELEASE_RATE)
            self._releases_left = RELEASES

    def released(self, now: float) -> None:
        """Count one message that let go."""
        self._releases_left -= 1
        if self._releases_left <= 0:
            super().stop(now)


class ManualControlSender(_HandSender):
    """Sends MANUAL_CONTROL to one system."""

    def __init__(self, local: Address, target: Address, rate: float = RATE) -> None:
        super().__init__(local, target, rate)
        self.input = ManualInput()

    def set(self, sticks: ManualInput, now: float) -> None:
        """Send this input from the next beat on, and begin if it is the first."""
        sticks.check()
        self.input = sticks
        if not self.active or self.releasing:
            self.start(now)

    def current_message(self, now: float) -> Message | None:
        if self.releasing:
            self.input = ManualInput()
            self.released(now)
        return self.input.to_message(self.target.system)


class OverrideSender(_HandSender):
    """Sends RC_CHANNELS_OVERRIDE to one component; a channel that is no longer given is given back."""

    def __init__(self, local: Address, target: Address, rate: float = RATE) -> None:
        super().__init__(local, target, rate)
        self._held: dict[int, int] = {}

    @property
    def override(self) -> ChannelOverride:
        """What is sent now."""
        return ChannelOverride(MappingProxyType(dict(self._held)))

    def set(self, override: ChannelOverride, now: float) -> None:
        """Override these channels from the next beat on; those that are no longer among them are released."""
        override.check()
        self._held = dict.fromkeys(self._held, RELEASE) | dict(override.channels)
        if not self.active or self.releasing:
            self.start(now)

    def current_message(self, now: float) -> Message | None:
        if self.releasing:
            self._held = dict.fromkeys(self._held, RELEASE)
            self.released(now)
        return self.override.to_message(self.target)
