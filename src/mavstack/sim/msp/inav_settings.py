"""The settings of iNav on a quad: their defaults, and their CLI names."""

from __future__ import annotations

from typing import Final

from mavstack.msp.firmware_info import INAV, FirmwareInfo
from mavstack.msp.messages.identification import BoardInfo, Name
from mavstack.msp.messages.pid import InavPid
from mavstack.msp.messages.rc import (
    InavRateProfile,
)
from mavstack.sim.msp.boxes import ModeRange
from mavstack.sim.msp.cli_settings import read_settings
from mavstack.sim.msp.default_settings import read_defaults
from mavstack.sim.msp.settings import SettingFacts

INFO: Final = FirmwareInfo(
    variant="INAV",
    version=(8, 0, 1),
    api=(2, 5),
    board="SITL",
    target="SITL",
    build="Feb 10 2025 12:00:00 6d617673",
    uid="0000000000000000000000b2",
)
_BOARD: Final = BoardInfo("SITL", 0, 0, 0, "SITL")

_MESSAGES: Final = (_BOARD, Name("mavstack"), *read_defaults("inav_defaults.toml", INAV))
CLI_SETTINGS: Final = read_settings("inav_settings.txt")


def inav_facts() -> SettingFacts:
    """Return the settings and their defaults.

    A new simulated controller has switches for its transmitter: arming on AUX 1, angle mode on AUX 2,
    position hold and missions on AUX 3, return to home on AUX 4, the beeper on AUX 5.
    """
    ranges = (
        ModeRange(0, 0, 32, 48),
        ModeRange(1, 1, 12, 48),
        ModeRange(11, 2, 20, 32),
        ModeRange(28, 2, 32, 48),
        ModeRange(10, 3, 32, 48),
        ModeRange(13, 4, 32, 48),
        ModeRange(31, 5, 32, 48),
    )
    named = CLI_SETTINGS.without_message
    return SettingFacts(
        INFO, _MESSAGES, frozenset((InavPid, InavRateProfile)), frozenset(), named, 40, ranges
    )
