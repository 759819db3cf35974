"""Switches of the pilot's transmitter: the flight mode channel, and channels with auxiliary functions.

FLTMODE_CH (Rover: MODE_CH) has six positions, each of which enters the mode of FLTMODE1 to FLTMODE6 when the
switch moves there; RCn_OPTION gives channel n a function with three positions. The first received positions
change nothing: the vehicle keeps its initial mode.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.sim.ardupilot.switches import HIGH, LOW, MIDDLE, use_auxiliary_function

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

#: Pulse widths in microseconds: the limits between the six positions of the flight mode switch, and the
#: limits of the low and high position of other switches.
_POSITION_LIMITS: Final = (1230, 1360, 1490, 1620, 1749)
_LOW_BELOW, _HIGH_ABOVE = 1200, 1800
_MIN_PULSE, _MAX_PULSE = 900, 2200
_OPTIONS: Final = tuple((channel, f"RC{channel}_OPTION") for channel in range(5, 17))


class ModeSwitch:
    """Reads the switches; one of the autopilot's periodic checks."""

    def __init__(self, autopilot: SimulatedAutopilot, mode_failure: ModeFailure) -> None:
        self._autopilot = autopilot
        self._mode_failure = mode_failure
        self._parameters = autopilot.vehicle.parameters
        prefix = "FLTMODE" if "FLTMODE_CH" in self._parameters else "MODE"
        self._channel = f"{prefix}_CH"
        self._modes = tuple(f"{prefix}{number}" for number in range(1, 7))
        #: Switch position of each channel, and the pulse widths of all channels at the last check.
        self._positions: dict[int, int] = {}
        self._last_channels: tuple[int, ...] = ()

    def tick(self, now: float) -> None:
        """Act on switches that moved."""
        radio = self._autopilot.radio
        if not radio.present:
            return
        channels = radio.channels
        if channels == self._last_channels:
            return
        self._last_channels = channels
        self._read_mode_channel(channels)
        for channel, option in _OPTIONS:
            function = int(self._parameters.get(option, 0))
            if function:
                self._read_option_channel(channel, channels[channel - 1], function)

    def _read_mode_channel(self, channels: tuple[int, ...]) -> None:
        """Enter the mode of the flight mode channel if it moved."""
        channel = int(self._parameters.get(self._channel, 0))
        if not 1 <= channel <= len(channels) or not _MIN_PULSE < channels[channel - 1] < _MAX_PULSE:
            return
        position = sum(channels[channel - 1] > limit for limit in _POSITION_LIMITS)
        if self._has_moved(0, position):
            self._enter(int(self._parameters[self._modes[position]]))

    def _read_option_channel(self, channel: int, pulse: int, function: int) -> None:
        """Execute the function of a channel if it moved."""
        if not _MIN_PULSE < pulse < _MAX_PULSE:
            return
        position = LOW if pulse < _LOW_BELOW else HIGH if pulse > _HIGH_ABOVE else MIDDLE
        if self._has_moved(channel, position):
            use_auxiliary_function(self._autopilot, function, position)

    def _has_moved(self, channel: int, position: int) -> bool:
        """Store a position; return whether it changed."""
        before = self._positions.get(channel)
        self._positions[channel] = position
        return before is not None and before != position

    def _enter(self, number: int) -> None:
        """Enter a mode, or report why not."""
        autopilot = self._autopilot
        mode = autopilot.find_mode(number)
        if mode is None or mode is autopilot.mode:
            return
        failure = self._mode_failure(autopilot, mode)
        if failure is not None:
            autopilot.vehicle.send_statustext(failure)
        else:
            autopilot.enter(number, "switch")
