"""Parsers of the replies of SiK radios: lists of parameters, numbers, reports of the signal.

Replies are lines of text from a device that may be another one, or a radio in the middle of a flight. A line
that is no reply is ignored; no line raises an error.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.radio.parameters import MAX_VALUE

if TYPE_CHECKING:
    from collections.abc import Iterable

_NODE: Final = r"\s*(?:\[\d{1,5}\]\s*)?"
_PARAMETER: Final = re.compile(
    _NODE + r"S(\d{1,3}):\s*([A-Z][A-Z0-9_/&]{0,31})(?:\([A-Z]\))?\s*=\s*(\d{1,10})\b.*", re.ASCII
)
_NUMBER: Final = re.compile(_NODE + r"(\d{1,10})\s*", re.ASCII)
_TIMING: Final = re.compile(_NODE + r"([a-z][a-z0-9_]{0,39}):\s*(\d{1,10})\s*", re.ASCII)
_PAIR: Final = r"(\d{1,5})/(\d{1,5})"
_RSSI: Final = re.compile(
    rf"L/R RSSI:\s*{_PAIR}\s+L/R noise:\s*{_PAIR}\s+pkts:\s*(\d{{1,10}})\s+txe=(\d{{1,10}})"
    rf"\s+rxe=(\d{{1,10}})\s+stx=(\d{{1,10}})\s+srx=(\d{{1,10}})\s+ecc=(\d{{1,10}})/(\d{{1,10}})"
    r"(?:\s+temp=(-?\d{1,5}))?(?:\s+dco=(\d{1,5}))?",
    re.ASCII,
)


class StoredParameter(NamedTuple):
    """A parameter of one radio: number of its register, and value."""

    number: int
    value: int


def parse_parameters(lines: Iterable[str]) -> dict[str, StoredParameter]:
    """Return the parameters in the reply to ATI5, by name.

    Args:
        lines: The lines of the reply; others than `Sn: NAME=value` are ignored.

    Returns:
        Number and value by name, in the order of the reply.
    """
    found: dict[str, StoredParameter] = {}
    for line in lines:
        if (match := _PARAMETER.fullmatch(line)) and int(match[3]) <= MAX_VALUE:
            found[match[2]] = StoredParameter(int(match[1]), int(match[3]))
    return found


def parse_number(line: str) -> int | None:
    """Return the number in the reply to ATI2, ATI3, ATI4 or ATSn?, or None if it is none."""
    match = _NUMBER.fullmatch(line)
    return int(match[1]) if match else None


def parse_timing(lines: Iterable[str]) -> dict[str, int]:
    """Return the numbers in the reply to ATI6, the timing of transmissions, by name.

    Args:
        lines: The lines of the reply; others than `name: number` are ignored.
    """
    matches = filter(None, map(_TIMING.fullmatch, lines))
    return {match[1]: int(match[2]) for match in matches}


def signal_dbm(value: int) -> float:
    """Return a signal or noise in dBm.

    Args:
        value: The value of the radio's chip, as in reports and in RADIO_STATUS.

    Returns:
        The power in dBm, by the approximation of ArduPilot's wiki.
    """
    return value / 1.9 - 127


@dataclass(frozen=True, slots=True)
class RssiReport:
    """A report about the link of two radios, as ATI7 and AT&T=RSSI print it.

    Attributes:
        local_rssi: Signal at this radio, in the unit of its chip (see `signal_dbm`).
        remote_rssi: Signal at the remote radio.
        local_noise: Noise at this radio.
        remote_noise: Noise at the remote radio.
        packets: Packets received since the report before.
        transmit_errors: Packets that could not be transmitted.
        receive_errors: Packets that were received with errors.
        serial_transmit_overflows: Bytes from the air that found a full buffer.
        serial_receive_overflows: Bytes from the serial port that found a full buffer.
        corrected_errors: Bits that error correction repaired.
        corrected_packets: Packets that error correction repaired.
        temperature: Temperature in degrees Celsius, or None.
        duty_cycle_offset: Reduction of the duty cycle by temperature in percent, or None.
    """

    local_rssi: int
    remote_rssi: int
    local_noise: int
    remote_noise: int
    packets: int
    transmit_errors: int
    receive_errors: int
    serial_transmit_overflows: int
    serial_receive_overflows: int
    corrected_errors: int
    corrected_packets: int
    temperature: int | None = None
    duty_cycle_offset: int | None = None

    @property
    def fade_margin(self) -> float:
        """The decibels by which the weaker signal may still fall; each 6 dB doubles the distance."""
        return min(self.local_rssi - self.local_noise, self.remote_rssi - self.remote_noise) / 1.9


def parse_rssi(line: str) -> RssiReport | None:
    """Return the report in a line, or None without a report; bytes of packets may surround it."""
    match = _RSSI.search(line)
    if match is None:
        return None
    *counts, temperature, offset = match.groups()
    optional = [None if each is None else int(each) for each in (temperature, offset)]
    return RssiReport(*(int(each) for each in counts), *optional)
