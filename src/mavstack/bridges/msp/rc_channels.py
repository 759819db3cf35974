"""The radio control channels that a bridge sends to a flight controller. It needs no event loop.

A flight controller is armed, and its modes are switched, by channels. Where its receiver takes them by MSP
(MSP_SET_RAW_RC), the bridge is the transmitter: it sends all channels at a steady rate while a component is
in control. The dead-man rule: without a sign of life of the component in control for `CONTROL_TIMEOUT`, the
bridge stops sending, and the failsafe of the flight controller takes over, as with a transmitter that is out
of range. It never sends a neutral value instead, which would keep a vehicle in the air without a pilot.

Channels are counted as the receiver counts them; the channel map says which of them is roll, pitch, yaw,
throttle, AUX 1 and so on. Those that it does not name have their own place: AUX 1 is channel 5.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.services import Address

#: Number of channels that are sent.
CHANNELS: Final = 16
#: Rate in hertz at which all channels are sent: Betaflight reports a lost signal after a pause of 0.3 s.
DEFAULT_RATE: Final = 25.0
#: Seconds without a heartbeat or command from the component in control after which the channels stop.
CONTROL_TIMEOUT: Final = 2.5
#: Pulse widths in microseconds.
LOW, MIDDLE = 1000, 1500
#: Index of the first AUX channel.
AUX: Final = 4
#: Sticks in the order of the channel map.
ROLL, PITCH, YAW, THROTTLE = range(4)
_STICK_RANGE: Final = 1000


class RcChannels:
    """The channels of one flight controller, and who is in control."""

    def __init__(self) -> None:
        #: The channel index of roll, pitch, yaw, throttle and then of each AUX channel.
        self.channel_map: tuple[int, ...] = (0, 1, 3, 2)
        self._sticks = [MIDDLE, MIDDLE, MIDDLE, LOW]
        self._aux = [LOW] * (CHANNELS - AUX)
        self._overrides: dict[int, int] = {}
        self._pilot: Address | None = None
        self._sign_at = 0.0

    @property
    def pilot(self) -> Address | None:
        """The component that is in control; None: none, and nothing is sent."""
        return self._pilot

    def may_control(self, source: Address) -> bool:
        """Return whether a component may take control: no other component has it."""
        return self._pilot in (None, source)

    def take_control(self, source: Address, now: float) -> None:
        """Give a component control, and count it as a sign of life."""
        self._pilot, self._sign_at = source, now

    def sign_of_life(self, source: Address, now: float) -> None:
        """Note that a component lives, such as by its heartbeat."""
        if source == self._pilot:
            self._sign_at = now

    def release_control(self) -> None:
        """End the control: sticks to the middle, throttle and AUX channels low, nothing is sent."""
        self._pilot = None
        self._sticks = [MIDDLE, MIDDLE, MIDDLE, LOW]
        self._aux = [LOW] * (CHANNELS - AUX)
        self._overrides.clear()

    def check_pilot(self, now: float) -> bool:
        """Release the control if its holder sends nothing; return True if it was released now."""
        if self._pilot is None or now < self._sign_at + CONTROL_TIMEOUT:
            return False
        self.release_control()
        return True

    def set_sticks(
        self, *, roll: int | None, pitch: int | None, yaw: int | None, throttle: int | None
    ) -> None:
        """Set sticks from -1000 to 1000, and the throttle from 0 to 1000; None keeps a stick."""
        for stick, value in ((ROLL, roll), (PITCH, pitch), (YAW, yaw)):
            if value is not None:
                self._sticks[stick] = MIDDLE + _clamp(value, -_STICK_RANGE) // 2
        if throttle is not None:
            self._sticks[THROTTLE] = LOW + _clamp(throttle, 0)

    def set_aux(self, index: int, pulse: int) -> None:
        """Set an AUX channel, counted from 0."""
        if 0 <= index < len(self._aux):
            self._aux[index] = pulse

    def aux(self, index: int) -> int:
        """Return the pulse of an AUX channel, counted from 0."""
        return self._aux[index] if 0 <= index < len(self._aux) else LOW

    def set_overrides(self, channels: Mapping[int, int]) -> None:
        """Set the channels that a pilot overrides: pulses by channel, counted from 1."""
        self._overrides = {channel - 1: pulse for channel, pulse in channels.items() if channel <= CHANNELS}

    def pulses(self) -> list[int]:
        """Return all channels in microseconds, in the order of the receiver."""
        pulses = self.to_receiver_order([*self._sticks, *self._aux])
        for channel, pulse in self._overrides.items():
            pulses[channel] = pulse
        return pulses

    def throttle_is_low(self) -> bool:
        """Return whether the throttle is at its lowest pulse."""
        return self.pulses()[self.channel_map[THROTTLE]] <= LOW

    def to_receiver_order(self, channels: Sequence[int]) -> list[int]:
        """Return channels of MSP_RC (roll, pitch, yaw, throttle, AUX 1 …) as the receiver counts them."""
        pulses = list(channels)
        for pulse, channel in zip(channels, self.channel_map, strict=False):
            if channel < len(pulses):
                pulses[channel] = pulse
        return pulses


def _clamp(value: int, minimum: int) -> int:
    return max(minimum, min(_STICK_RANGE, value))
