"""The settings of iNav on a quad: their defaults, and their CLI names."""

from __future__ import annotations

from typing import Final

from mavstack.msp.firmware_info import FirmwareInfo
from mavstack.msp.messages.battery import InavBatteryConfig
from mavstack.msp.messages.blackbox import BlackboxDevice, InavBlackboxConfig
from mavstack.msp.messages.config import (
    ArmingConfig,
    FeatureConfig,
    InavFeature,
    SerialConfig,
    SerialFunction,
    SerialPort,
)
from mavstack.msp.messages.identification import BoardInfo, Name
from mavstack.msp.messages.motors import InavMixer, Motor3dConfig
from mavstack.msp.messages.navigation import FwConfig, NavPoshold, RthAndLandConfig
from mavstack.msp.messages.pid import InavGains, InavPid
from mavstack.msp.messages.rc import (
    FailsafeConfig,
    FailsafeProcedure,
    InavRateProfile,
    RcDeadband,
    RssiConfig,
    RxConfig,
    RxMap,
)
from mavstack.msp.messages.sensors import BoardAlignmentConfig, SensorConfig
from mavstack.sim.msp.boxes import ModeRange
from mavstack.sim.msp.cli_settings import read_settings
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

_MESSAGES: Final = (
    _BOARD,
    Name("mavstack"),
    FeatureConfig(InavFeature.VBAT | InavFeature.GPS | InavFeature.TELEMETRY | InavFeature.CURRENT_METER),
    ArmingConfig(5, 0),
    InavPid(
        tuple(
            InavGains(*gains)
            for gains in (
                (40, 30, 23, 60),
                (40, 30, 23, 60),
                (85, 45, 0, 60),
                (50, 0, 0, 0),
                (65, 0, 0, 0),
                (40, 15, 100, 40),
                (0, 0, 0, 0),
                (20, 15, 75, 0),
                (60, 0, 0, 0),
                (100, 50, 10, 0),
                (30, 2, 0, 0),
            )
        )
    ),
    InavRateProfile(50, 0, 0, 1500, 70, 20, 20, 20, 20, 35, 20, 100, 100, 100),
    RcDeadband(5, 5, 10, 50),
    RxConfig(0, 1900, 1500, 1100, 0, 885, 2115, 0, 0, 1300, 0, 0, 0, 0, 2),
    RxMap((0, 1, 3, 2)),
    RssiConfig(0),
    FailsafeConfig(0.5, 200, 1000, 0, 0, FailsafeProcedure.AUTO_LANDING, 0.5, -20, 10, -45, 50, 0, 1),
    NavPoshold(0, 10.0, 5.0, 7.5, 2.0, 35, 0, 1300),
    RthAndLandConfig(5.0, 1, False, False, 1, 4, 500.0, 10.0, 0.5, 2.0, 5.0, 20.0, 5.0),
    FwConfig(1400, 1200, 1700, 35, 20, 15, 10, 75.0),
    InavBatteryConfig(1100, 0, 0, 4.25, 3.3, 4.2, 3.5, 0, 250, 5200, 0, 0, 0),
    InavMixer(False, 0, False, 0, False, 3, 12, 16),
    Motor3dConfig(1406, 1514, 1460),
    SensorConfig(0, 1, 1, 0, 0, 0),
    BoardAlignmentConfig(0, 0, 0),
    InavBlackboxConfig(True, BlackboxDevice.FLASH, 1, 2, 0),
    SerialConfig(
        (
            SerialPort(20, SerialFunction.MSP, 5, 4, 0, 5),
            SerialPort(0, SerialFunction.MSP, 5, 4, 0, 5),
            SerialPort(1, SerialFunction.GPS, 5, 5, 0, 5),
        )
    ),
)

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
