"""The RC receiver of a flight controller: channels come by MSP_SET_RAW_RC.

A transmitter sends channels in the order of the channel map ("AETR": roll, pitch, throttle, yaw); the
firmwares keep them as roll, pitch, yaw, throttle, AUX1, AUX2 …, and report them in this order. Without a
frame for `SIGNAL_TIMEOUT` the signal is lost: roll, pitch and yaw go to the middle, the throttle to its
minimum, and the AUX channels keep their values, as both firmwares do by default.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Number of channels that a controller stores.
CHANNELS: Final = 18
#: Seconds without a frame after which the signal is lost.
SIGNAL_TIMEOUT: Final = 0.3
#: Microseconds: the middle and the lowest value of a channel, and the limits of a valid pulse.
MIDDLE, LOW = 1500, 1000
MIN_PULSE, MAX_PULSE = 885, 2115
#: Indices of the channels in the order of the firmware.
ROLL, PITCH, YAW, THROTTLE, AUX = 0, 1, 2, 3, 4
#: The throttle when the signal is lost, in microseconds.
LOST_THROTTLE = 885
_LETTERS: Final = "AERT12345678"
_HALF_RANGE = 500.0


class Sticks(NamedTuple):
    """Positions of the sticks: roll, pitch (forward positive) and yaw -1 to 1, throttle 0 to 1."""

    roll: float
    pitch: float
    yaw: float
    throttle: float


class Receiver:
    """The channels of one controller, in microseconds."""

    def __init__(self) -> None:
        self.channels = [MIDDLE] * THROTTLE + [LOST_THROTTLE] + [LOW] * (CHANNELS - AUX)
        #: For each of the first eight channels of the firmware: the index of the channel in received frames.
        self.channel_map: tuple[int, ...] = map_of("AETR1234")
        #: True while the transmitter is switched on; a fault can switch it off.
        self.is_on = True
        self._last_frame = -SIGNAL_TIMEOUT
        self._count = 0

    def receive(self, frame: Sequence[int], now: float) -> None:
        """Process the channels of one MSP_SET_RAW_RC, in microseconds; invalid pulses keep the last value."""
        if not self.is_on:
            return
        self._last_frame, self._count = now, max(self._count, len(frame))
        for index in range(min(len(frame), CHANNELS)):
            source = self.channel_map[index] if index < len(self.channel_map) else index
            if source < len(frame) and MIN_PULSE <= frame[source] <= MAX_PULSE:
                self.channels[index] = frame[source]

    @property
    def count(self) -> int:
        """Number of channels that the controller reports: those of the transmitter, at least eight."""
        return min(max(self._count, 8), CHANNELS)

    def has_signal(self, now: float) -> bool:
        """Return whether a frame came within `SIGNAL_TIMEOUT`."""
        return self.is_on and self._count >= AUX and now - self._last_frame <= SIGNAL_TIMEOUT

    def step(self, now: float) -> None:
        """Put the channels to their values without signal, if it is lost."""
        if not self.has_signal(now):
            self.channels[:AUX] = [MIDDLE, MIDDLE, MIDDLE, LOST_THROTTLE]

    def sticks(self, min_check: int = 1050, deadband: int = 0, yaw_deadband: int = 0) -> Sticks:
        """Return the positions of the sticks.

        Args:
            min_check: Throttle in microseconds at and below which it counts as low.
            deadband: Microseconds around the middle of roll and pitch that count as the middle.
            yaw_deadband: As `deadband`, for yaw.
        """
        roll, pitch, yaw, throttle = self.channels[:AUX]
        return Sticks(
            _deflection(roll, deadband),
            _deflection(pitch, deadband),
            _deflection(yaw, yaw_deadband),
            min(max((throttle - min_check) / (2000 - min_check), 0.0), 1.0),
        )


def map_of(letters: str) -> tuple[int, ...]:
    """Return the channel map of letters such as "AETR1234"; raises ValueError for letters that are no map."""
    if len(letters) != len(set(letters)) or not set("AERT") <= set(letters) <= set(_LETTERS):
        raise ValueError(letters)
    order = "AERT12345678"[: len(letters)]
    return tuple(letters.index(letter) for letter in order)


def letters_of(channel_map: Sequence[int]) -> str:
    """Return the letters of a channel map."""
    letters = [""] * len(channel_map)
    for letter, place in zip(_LETTERS, channel_map, strict=False):
        if place < len(letters):  # a peer may have written an invalid index
            letters[place] = letter
    return "".join(letters)


def _deflection(channel: int, deadband: int) -> float:
    """Return the deflection of a channel from -1 to 1, without the deadband."""
    offset = channel - MIDDLE
    if abs(offset) <= deadband:
        return 0.0
    offset -= deadband if offset > 0 else -deadband
    return min(max(offset / (_HALF_RANGE - deadband), -1.0), 1.0)
