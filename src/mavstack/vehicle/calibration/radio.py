"""The radio control calibration: the program measures the pulses of the channels and sets their parameters.

The firmware only has to be told that a calibration runs, so that it ignores the sticks. Both firmwares name
the parameters RC1_MIN, RC1_TRIM, RC1_MAX, and likewise for the other channels.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.calibration.conversation import TURN_TIMEOUT
from mavstack.vehicle.calibration.kinds import CalibrationResult, CalibrationTask, ChannelRange

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.dialects import Message
    from mavstack.vehicle.calibration.conversation import Conversation

#: The rate of RC_CHANNELS during a calibration, in hertz.
_RATE: Final = 10.0
#: A channel whose pulses change less than this, in microseconds, is not calibrated.
MIN_TRAVEL: Final = 300
#: The valid pulses of a receiver, in microseconds; other values mean that a channel is not used.
_PULSES: Final = range(700, 2500)
_MOVE: Final = "Move all sticks, switches and dials to both of their ends, several times; then confirm."
_CENTER: Final = "Center the sticks and put the throttle all the way down; then confirm."


async def calibrate_radio(
    conversation: Conversation, ignore_sticks: Callable[[bool], Awaitable[None]]
) -> None:
    """Hold the conversation; `ignore_sticks` tells the vehicle that the calibration runs, or has ended."""
    vehicle, channels = conversation.vehicle, _Channels()
    await vehicle.telemetry.ensure(common.RcChannels, _RATE)
    await ignore_sticks(True)
    conversation.running = True
    conversation.listen(common.RcChannels, channels.update)
    conversation.emit_step(CalibrationTask.WAIT, "Waiting for the radio control receiver.")
    await conversation.wait(lambda: bool(channels.now), TURN_TIMEOUT)
    await conversation.ask(CalibrationTask.MOVE_STICKS, _MOVE, progress=0)
    await conversation.ask(CalibrationTask.CENTER_STICKS, _CENTER, progress=50)
    ranges = channels.ranges()
    if not ranges:
        raise conversation.failure(f"no channel moved by {MIN_TRAVEL} us or more")
    await _set_parameters(conversation, ranges)
    await ignore_sticks(False)
    conversation.running = False
    conversation.result = CalibrationResult(conversation.kind, channels=MappingProxyType(ranges))


class _Channels:
    """The pulses of all channels: now, and the shortest and the longest so far."""

    def __init__(self) -> None:
        self.now: dict[int, int] = {}
        self._minimum: dict[int, int] = {}
        self._maximum: dict[int, int] = {}

    def update(self, message: Message) -> None:
        """Take in an RC_CHANNELS."""
        for number in range(1, 19):
            pulse = getattr(message, f"chan{number}_raw")
            if pulse in _PULSES:
                self.now[number] = pulse
                self._minimum[number] = min(pulse, self._minimum.get(number, pulse))
                self._maximum[number] = max(pulse, self._maximum.get(number, pulse))

    def ranges(self) -> dict[int, ChannelRange]:
        """Return the ranges of the channels that moved."""
        return {
            number: ChannelRange(self._minimum[number], pulse, self._maximum[number])
            for number, pulse in sorted(self.now.items())
            if self._maximum[number] - self._minimum[number] >= MIN_TRAVEL
        }


async def _set_parameters(conversation: Conversation, ranges: dict[int, ChannelRange]) -> None:
    params = conversation.vehicle.params
    for done, (number, channel) in enumerate(ranges.items()):
        share = 50 + 50 * done // len(ranges)
        conversation.emit_step(
            CalibrationTask.WAIT, "Setting the parameters of the channels.", progress=share
        )
        for name, value in (("MIN", channel.minimum), ("MAX", channel.maximum), ("TRIM", channel.trim)):
            await params.set(f"RC{number}_{name}", value)
