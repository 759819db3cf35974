"""The switches of the pilot's transmitter: the flight mode's channel, and channels with other functions.

FLTMODE_CH (Rover: MODE_CH) has six positions, each of which enters the mode of FLTMODE1 to FLTMODE6 when the
switch comes to it and stays; RCn_OPTION gives channel n a function at three positions. Where the switches
stand when they are first heard changes nothing: the vehicle keeps the mode that it began in.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.sim.ardupilot.switches import HIGH, LOW, MIDDLE, use_auxiliary_function

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.interfaces import Autopilot

#: Pulses in microseconds: the flight mode's positions end here, those of the others begin and end there.
_ENDS: Final = (1230, 1360, 1490, 1620, 1749)
_LOW_BELOW, _HIGH_ABOVE = 1200, 1800
_LEAST, _MOST = 900, 2200
_OPTIONS: Final = tuple((channel, f"RC{channel}_OPTION") for channel in range(5, 17))


class ModeSwitch:
    """Reads the switches; one of its autopilot's watches."""

    def __init__(self, autopilot: Autopilot, mode_failure: ModeFailure) -> None:
        self._autopilot = autopilot
        self._mode_failure = mode_failure
        self._parameters = autopilot.vehicle.parameters
        prefix = "FLTMODE" if "FLTMODE_CH" in self._parameters else "MODE"
        self._channel = f"{prefix}_CH"
        self._modes = tuple(f"{prefix}{number}" for number in range(1, 7))
        #: Where each channel's switch stands, and where it stood at the look before.
        self._positions: dict[int, int] = {}
        self._seen: tuple[int, ...] = ()

    def tick(self, now: float) -> None:
        """Look, and do what a switch wants that has moved."""
        radio = self._autopilot.radio
        if not radio.present:
            return
        channels = radio.channels
        if channels == self._seen:
            return
        self._seen = channels
        self._look_at_mode(channels)
        for channel, option in _OPTIONS:
            function = int(self._parameters.get(option, 0))
            if function:
                self._look_at_option(channel, channels[channel - 1], function)

    def _look_at_mode(self, channels: tuple[int, ...]) -> None:
        channel = int(self._parameters.get(self._channel, 0))
        if not 1 <= channel <= len(channels) or not _LEAST < channels[channel - 1] < _MOST:
            return
        position = sum(channels[channel - 1] > end for end in _ENDS)
        if self._has_moved(0, position):
            self._enter(int(self._parameters[self._modes[position]]))

    def _look_at_option(self, channel: int, pulse: int, function: int) -> None:
        if not _LEAST < pulse < _MOST:
            return
        position = LOW if pulse < _LOW_BELOW else HIGH if pulse > _HIGH_ABOVE else MIDDLE
        if self._has_moved(channel, position):
            use_auxiliary_function(self._autopilot, function, position)

    def _has_moved(self, channel: int, position: int) -> bool:
        before = self._positions.get(channel)
        self._positions[channel] = position
        return before is not None and before != position

    def _enter(self, number: int) -> None:
        autopilot = self._autopilot
        mode = autopilot.find_mode(number)
        if mode is None or mode is autopilot.mode:
            return
        failure = self._mode_failure(autopilot, mode)
        if failure is not None:
            autopilot.vehicle.send_statustext(failure)
        else:
            autopilot.enter(number, "switch")
