"""The settings of Betaflight 4.5 on a quad, and their CLI names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.msp.firmware_info import FirmwareInfo
from mavstack.msp.messages.identification import BoardInfo, Name
from mavstack.msp.messages.pid import Pid, PidAdvanced, SimplifiedTuning
from mavstack.msp.messages.rc import RcTuning
from mavstack.sim.msp.betaflight_peripherals import PERIPHERALS
from mavstack.sim.msp.boxes import ModeRange
from mavstack.sim.msp.cli_settings import read_settings
from mavstack.sim.msp.default_settings import read_defaults
from mavstack.sim.msp.settings import SettingFacts

if TYPE_CHECKING:
    from mavstack.msp.messages.base import MspMessage

INFO: Final = FirmwareInfo(
    variant="BTFL",
    version=(4, 5, 2),
    api=(1, 46),
    board="S405",
    target="STM32F405",
    build="Mar 25 2025 12:00:00 6d61767",
    uid="0000000000000000000000b1",
)
_BOARD: Final = BoardInfo(
    "S405", 0, 2, 0x37, "STM32F405", "MAVSTACKSIM", "MAVS", bytes(32) + b"\x01\x02\x40\x1f" + bytes(6)
)
PID_PROFILE_KINDS: Final[frozenset[type[MspMessage]]] = frozenset((Pid, PidAdvanced, SimplifiedTuning))
RATE_PROFILE_KINDS: Final[frozenset[type[MspMessage]]] = frozenset((RcTuning,))
MESSAGES: Final = (_BOARD, Name("mavstack"), *read_defaults("betaflight_defaults.toml"), *PERIPHERALS)
CLI_SETTINGS: Final = read_settings("betaflight_settings.txt")


def betaflight_facts() -> SettingFacts:
    """Return the settings and their defaults.

    A new simulated controller has switches for its transmitter: arming on AUX 1, angle mode on AUX 2, GPS
    Rescue on AUX 3, the beeper on AUX 4.
    """
    ranges = (
        ModeRange(0, 0, 32, 48),
        ModeRange(1, 1, 12, 48),
        ModeRange(46, 2, 32, 48),
        ModeRange(13, 3, 32, 48),
    )
    named = CLI_SETTINGS.without_message
    return SettingFacts(INFO, MESSAGES, PID_PROFILE_KINDS, RATE_PROFILE_KINDS, named, 20, ranges)
