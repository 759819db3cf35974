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
from mavstack.sim.msp.cli_settings import CliSetting, SettingTable, named_settings
from mavstack.sim.msp.settings import NamedSetting, SettingFacts

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
_OFF_ON: Final = ("OFF", "ON")

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

#: Settings without a message.
_NAMED: Final = {
    "nav_auto_speed": NamedSetting(500, 10, 2000),
    "nav_wp_radius": NamedSetting(100, 10, 10_000),
    "nav_wp_max_safe_distance": NamedSetting(100, 0, 1500),
    "nav_disarm_on_landing": NamedSetting(0, 0, 1, _OFF_ON),
    "nav_extra_arming_safety": NamedSetting(0, 0, 1, ("ON", "ALLOW_BYPASS")),
    "max_angle_inclination_rll": NamedSetting(300, 100, 900),
    "max_angle_inclination_pit": NamedSetting(300, 100, 900),
    "nav_wp_enforce_altitude": NamedSetting(0, 0, 2000),
    "heading_hold_rate_limit": NamedSetting(90, 10, 250),
}

#: The CLI name of each field that is in a message, with its limits or its words.
_FIELDS: Final[tuple[tuple[str, type, tuple[str | int, ...], int | tuple[str, ...], int], ...]] = (
    ("min_check", RxConfig, ("min_check",), 1000, 2000),
    ("max_check", RxConfig, ("max_check",), 1000, 2000),
    ("rx_min_usec", RxConfig, ("rx_min",), 750, 2250),
    ("rx_max_usec", RxConfig, ("rx_max",), 750, 2250),
    ("failsafe_delay", FailsafeConfig, ("delay",), 0, 200),
    ("failsafe_recovery_delay", FailsafeConfig, ("recovery_delay",), 0, 200),
    ("failsafe_off_delay", FailsafeConfig, ("landing_time",), 0, 200),
    ("failsafe_throttle_low_delay", FailsafeConfig, ("throttle_low_delay",), 0, 300),
    ("failsafe_procedure", FailsafeConfig, ("procedure",), ("LAND", "DROP", "RTH", "NONE"), 0),
    ("failsafe_stick_threshold", FailsafeConfig, ("stick_threshold",), 0, 500),
    ("failsafe_min_distance", FailsafeConfig, ("min_distance",), 0, 65000),
    ("deadband", RcDeadband, ("deadband",), 0, 32),
    ("yaw_deadband", RcDeadband, ("yaw_deadband",), 0, 100),
    ("pos_hold_deadband", RcDeadband, ("hold_deadband",), 2, 250),
    ("rssi_channel", RssiConfig, ("channel",), 0, 18),
    ("align_board_roll", BoardAlignmentConfig, ("roll",), -1800, 3600),
    ("align_board_pitch", BoardAlignmentConfig, ("pitch",), -1800, 3600),
    ("align_board_yaw", BoardAlignmentConfig, ("yaw",), -1800, 3600),
    ("battery_capacity", InavBatteryConfig, ("capacity",), 0, 4_294_967_295),
    ("vbat_min_cell_voltage", InavBatteryConfig, ("cell_min",), 100, 500),
    ("vbat_max_cell_voltage", InavBatteryConfig, ("cell_max",), 100, 500),
    ("vbat_warning_cell_voltage", InavBatteryConfig, ("cell_warning",), 100, 500),
    ("nav_user_control_mode", NavPoshold, ("user_control_mode",), ("ATTI", "CRUISE"), 0),
    ("nav_max_auto_speed", NavPoshold, ("max_auto_speed",), 10, 2000),
    ("nav_mc_auto_climb_rate", NavPoshold, ("max_auto_climb_rate",), 10, 2000),
    ("nav_manual_speed", NavPoshold, ("max_manual_speed",), 10, 2000),
    ("nav_mc_manual_climb_rate", NavPoshold, ("max_manual_climb_rate",), 10, 2000),
    ("nav_mc_bank_angle", NavPoshold, ("max_bank_angle",), 15, 45),
    ("nav_mc_hover_thr", NavPoshold, ("hover_throttle",), 1000, 2000),
    ("nav_min_rth_distance", RthAndLandConfig, ("min_distance",), 0, 5000),
    ("nav_rth_climb_first", RthAndLandConfig, ("climb_first",), ("OFF", "ON", "ON_FW_SPIRAL"), 0),
    ("nav_rth_climb_ignore_emerg", RthAndLandConfig, ("climb_ignore_emergency",), _OFF_ON, 0),
    ("nav_rth_tail_first", RthAndLandConfig, ("tail_first",), _OFF_ON, 0),
    ("nav_rth_allow_landing", RthAndLandConfig, ("allow_landing",), ("NEVER", "ALWAYS", "FS_ONLY"), 0),
    (
        "nav_rth_alt_mode",
        RthAndLandConfig,
        ("altitude_mode",),
        ("CURRENT", "EXTRA", "FIXED", "MAX", "AT_LEAST"),
        0,
    ),
    ("nav_rth_abort_threshold", RthAndLandConfig, ("abort_threshold",), 0, 65000),
    ("nav_rth_altitude", RthAndLandConfig, ("altitude",), 0, 65000),
    ("nav_land_minalt_vspd", RthAndLandConfig, ("land_min_altitude_speed",), 50, 500),
    ("nav_land_maxalt_vspd", RthAndLandConfig, ("land_max_altitude_speed",), 100, 2000),
    ("nav_land_slowdown_minalt", RthAndLandConfig, ("land_slowdown_min_altitude",), 50, 1000),
    ("nav_land_slowdown_maxalt", RthAndLandConfig, ("land_slowdown_max_altitude",), 500, 4000),
    ("nav_emerg_landing_speed", RthAndLandConfig, ("emergency_descent_rate",), 100, 2000),
    ("rc_expo", InavRateProfile, ("rc_expo",), 0, 100),
    ("rc_yaw_expo", InavRateProfile, ("yaw_expo",), 0, 100),
    ("roll_rate", InavRateProfile, ("roll_rate",), 4, 180),
    ("pitch_rate", InavRateProfile, ("pitch_rate",), 4, 180),
    ("yaw_rate", InavRateProfile, ("yaw_rate",), 1, 180),
    ("thr_mid", InavRateProfile, ("throttle_mid",), 0, 100),
    ("thr_expo", InavRateProfile, ("throttle_expo",), 0, 100),
    ("tpa_rate", InavRateProfile, ("tpa_rate",), 0, 200),
    ("tpa_breakpoint", InavRateProfile, ("tpa_breakpoint",), 1000, 2000),
    *(
        (f"mc_{letter if letter != 'f' else 'cd'}_{axis}", InavPid, ("controllers", index, letter), 0, 255)
        for index, axis in enumerate(("roll", "pitch", "yaw"))
        for letter in "pidf"
    ),
    ("mc_p_level", InavPid, ("controllers", 7, "p"), 0, 255),
    ("mc_i_level", InavPid, ("controllers", 7, "i"), 0, 255),
    ("mc_d_level", InavPid, ("controllers", 7, "d"), 0, 255),
    ("nav_mc_pos_z_p", InavPid, ("controllers", 3, "p"), 0, 255),
    ("nav_mc_pos_xy_p", InavPid, ("controllers", 4, "p"), 0, 255),
    ("nav_mc_vel_xy_p", InavPid, ("controllers", 5, "p"), 0, 255),
    ("nav_mc_vel_xy_i", InavPid, ("controllers", 5, "i"), 0, 255),
    ("nav_mc_vel_xy_d", InavPid, ("controllers", 5, "d"), 0, 255),
    ("nav_mc_vel_z_p", InavPid, ("controllers", 9, "p"), 0, 255),
    ("nav_mc_vel_z_i", InavPid, ("controllers", 9, "i"), 0, 255),
    ("nav_mc_vel_z_d", InavPid, ("controllers", 9, "d"), 0, 255),
)

CLI_SETTINGS: Final = SettingTable(
    (
        CliSetting("name", Name, ("name",), 0, 16, (), is_text=True),
        *(
            CliSetting(name, kind, path, 0, 0, low)
            if isinstance(low, tuple)
            else CliSetting(name, kind, path, low, high)
            for name, kind, path, low, high in _FIELDS
        ),
        *named_settings(_NAMED.items()),
    )
)


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
    return SettingFacts(
        INFO, _MESSAGES, frozenset((InavPid, InavRateProfile)), frozenset(), _NAMED, 40, ranges
    )
