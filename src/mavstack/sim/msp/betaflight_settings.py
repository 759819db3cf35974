"""The settings of Betaflight 4.5 on a quad, and their CLI names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.msp.firmware_info import FirmwareInfo
from mavstack.msp.messages.battery import BatteryConfig
from mavstack.msp.messages.blackbox import BlackboxConfig
from mavstack.msp.messages.config import ArmingConfig
from mavstack.msp.messages.filters import AdvancedConfig, FilterConfig
from mavstack.msp.messages.gps import GpsConfig, GpsRescue, GpsRescuePids
from mavstack.msp.messages.identification import Name
from mavstack.msp.messages.motors import MixerConfig, Motor3dConfig, MotorConfig
from mavstack.msp.messages.osd import OsdConfig
from mavstack.msp.messages.pid import Pid, PidAdvanced, SimplifiedTuning
from mavstack.msp.messages.rc import FailsafeConfig, RcDeadband, RcTuning, RssiConfig, RxConfig
from mavstack.msp.messages.sensors import AccTrim, BoardAlignmentConfig, CompassConfig
from mavstack.msp.messages.vtx import VtxConfig
from mavstack.sim.msp.betaflight_defaults import MESSAGES
from mavstack.sim.msp.betaflight_peripherals import PERIPHERALS
from mavstack.sim.msp.boxes import ModeRange
from mavstack.sim.msp.cli_settings import CliSetting, SettingTable, named_settings
from mavstack.sim.msp.settings import NamedSetting, SettingFacts

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
_OFF_ON: Final = ("OFF", "ON")
_LPF: Final = ("PT1", "BIQUAD", "PT2", "PT3")
_PROTOCOLS: Final = (
    "PWM",
    "ONESHOT125",
    "ONESHOT42",
    "MULTISHOT",
    "BRUSHED",
    "DSHOT150",
    "DSHOT300",
    "DSHOT600",
    "PROSHOT1000",
    "DISABLED",
)

#: Settings without a message.
_NAMED: Final = {
    "failsafe_recovery_delay": NamedSetting(10, 1, 200),
    "pwr_on_arm_grace": NamedSetting(5, 0, 30),
    "prearm_allow_rearm": NamedSetting(0, 0, 1, _OFF_ON),
    "runaway_takeoff_prevention": NamedSetting(1, 0, 1, _OFF_ON),
    "dshot_burst": NamedSetting(2, 0, 2, ("OFF", "ON", "AUTO")),
    "yaw_spin_recovery": NamedSetting(2, 0, 2, ("OFF", "ON", "AUTO")),
    "horizon_level_strength": NamedSetting(75, 0, 100),
}

_Field = tuple[str, type, tuple[str | int, ...], int | tuple[str, ...], int]


def _same(kind: type, *entries: tuple[str, int | tuple[str, ...], int]) -> tuple[_Field, ...]:
    """Return fields whose CLI name is the name of the field."""
    return tuple((name, kind, (name,), low, high) for name, low, high in entries)


#: The CLI name of each field that is in a message, with its limits or its words.
_MASTER: Final[tuple[_Field, ...]] = (
    *_same(
        FilterConfig,
        ("gyro_lpf1_type", _LPF, 0),
        ("gyro_lpf1_static_hz", 0, 1000),
        ("gyro_lpf2_type", _LPF, 0),
        ("gyro_lpf2_static_hz", 0, 1000),
        ("gyro_notch1_hz", 0, 1000),
        ("gyro_notch1_cutoff", 0, 1000),
        ("gyro_notch2_hz", 0, 1000),
        ("gyro_notch2_cutoff", 0, 1000),
        ("gyro_lpf1_dyn_min_hz", 0, 1000),
        ("gyro_lpf1_dyn_max_hz", 0, 1000),
        ("dyn_notch_count", 0, 5),
        ("dyn_notch_q", 1, 1000),
        ("dyn_notch_min_hz", 60, 250),
        ("dyn_notch_max_hz", 200, 1000),
        ("rpm_filter_harmonics", 0, 3),
        ("rpm_filter_min_hz", 30, 200),
    ),
    ("acc_trim_pitch", AccTrim, ("pitch",), -300, 300),
    ("acc_trim_roll", AccTrim, ("roll",), -300, 300),
    *_same(RxConfig, ("mid_rc", 1200, 1700), ("min_check", 750, 2250), ("max_check", 750, 2250)),
    ("rx_min_usec", RxConfig, ("rx_min",), 750, 2250),
    ("rx_max_usec", RxConfig, ("rx_max",), 750, 2250),
    ("rc_smoothing", RxConfig, ("rc_smoothing",), _OFF_ON, 0),
    ("rc_smoothing_auto_factor", RxConfig, ("rc_smoothing_factor",), 0, 250),
    ("rssi_channel", RssiConfig, ("channel",), 0, 18),
    ("blackbox_sample_rate", BlackboxConfig, ("sample_rate",), ("1/1", "1/2", "1/4", "1/8", "1/16"), 0),
    ("blackbox_device", BlackboxConfig, ("device",), ("NONE", "SPIFLASH", "SDCARD", "SERIAL"), 0),
    *_same(MotorConfig, ("min_throttle", 750, 2250), ("max_throttle", 750, 2250), ("min_command", 750, 2250)),
    ("motor_poles", MotorConfig, ("pole_count",), 4, 255),
    ("dshot_bidir", MotorConfig, ("use_dshot_telemetry",), _OFF_ON, 0),
    ("motor_pwm_protocol", AdvancedConfig, ("motor_protocol",), _PROTOCOLS, 0),
    ("motor_pwm_rate", AdvancedConfig, ("motor_pwm_rate",), 200, 32000),
    ("dshot_idle_value", AdvancedConfig, ("motor_idle",), 0, 2000),
    ("pid_process_denom", AdvancedConfig, ("pid_process_denom",), 1, 16),
    ("failsafe_delay", FailsafeConfig, ("delay",), 1, 200),
    ("failsafe_landing_time", FailsafeConfig, ("landing_time",), 0, 250),
    ("failsafe_throttle", FailsafeConfig, ("throttle",), 750, 2250),
    ("failsafe_switch_mode", FailsafeConfig, ("switch_mode",), ("STAGE1", "KILL", "STAGE2"), 0),
    ("failsafe_throttle_low_delay", FailsafeConfig, ("throttle_low_delay",), 0, 300),
    ("failsafe_procedure", FailsafeConfig, ("procedure",), ("AUTO-LAND", "DROP", "GPS-RESCUE"), 0),
    ("align_board_roll", BoardAlignmentConfig, ("roll",), -180, 360),
    ("align_board_pitch", BoardAlignmentConfig, ("pitch",), -180, 360),
    ("align_board_yaw", BoardAlignmentConfig, ("yaw",), -180, 360),
    ("bat_capacity", BatteryConfig, ("capacity",), 0, 20000),
    ("vbat_max_cell_voltage", BatteryConfig, ("cell_max",), 100, 500),
    ("vbat_min_cell_voltage", BatteryConfig, ("cell_min",), 100, 500),
    ("vbat_warning_cell_voltage", BatteryConfig, ("cell_warning",), 100, 500),
    ("current_meter", BatteryConfig, ("current_source",), ("NONE", "ADC", "VIRTUAL", "ESC", "MSP"), 0),
    ("battery_meter", BatteryConfig, ("voltage_source",), ("NONE", "ADC", "ESC"), 0),
    ("yaw_motors_reversed", MixerConfig, ("yaw_motors_reversed",), _OFF_ON, 0),
    ("3d_deadband_low", Motor3dConfig, ("deadband_low",), 750, 1500),
    ("3d_deadband_high", Motor3dConfig, ("deadband_high",), 1500, 2250),
    ("3d_neutral", Motor3dConfig, ("neutral",), 750, 2250),
    ("small_angle", ArmingConfig, ("small_angle",), 0, 180),
    ("auto_disarm_delay", ArmingConfig, ("auto_disarm_delay",), 0, 60),
    ("gyro_cal_on_first_arm", ArmingConfig, ("gyro_cal_on_first_arm",), _OFF_ON, 0),
    ("gps_provider", GpsConfig, ("provider",), ("NMEA", "UBLOX", "MSP", "VIRTUAL"), 0),
    ("gps_auto_config", GpsConfig, ("auto_config",), _OFF_ON, 0),
    ("gps_set_home_point_once", GpsConfig, ("set_home_point_once",), _OFF_ON, 0),
    ("gps_ublox_use_galileo", GpsConfig, ("ublox_use_galileo",), _OFF_ON, 0),
    ("gps_rescue_min_start_dist", GpsRescue, ("min_start_distance",), 10, 30),
    ("gps_rescue_alt_mode", GpsRescue, ("altitude_mode",), ("MAX_ALT", "FIXED_ALT", "CURRENT_ALT"), 0),
    ("gps_rescue_initial_climb", GpsRescue, ("initial_climb",), 0, 100),
    ("gps_rescue_ascend_rate", GpsRescue, ("ascend_rate",), 50, 2500),
    ("gps_rescue_return_alt", GpsRescue, ("return_altitude",), 5, 1000),
    ("gps_rescue_ground_speed", GpsRescue, ("ground_speed",), 0, 3000),
    ("gps_rescue_max_angle", GpsRescue, ("max_angle",), 30, 60),
    ("gps_rescue_descent_dist", GpsRescue, ("descent_distance",), 10, 500),
    ("gps_rescue_descend_rate", GpsRescue, ("descend_rate",), 25, 500),
    (
        "gps_rescue_sanity_checks",
        GpsRescue,
        ("sanity_checks",),
        ("RESCUE_SANITY_OFF", "RESCUE_SANITY_ON", "RESCUE_SANITY_FS_ONLY"),
        0,
    ),
    ("gps_rescue_min_sats", GpsRescue, ("min_satellites",), 5, 50),
    ("gps_rescue_allow_arming_without_fix", GpsRescue, ("allow_arming_without_fix",), _OFF_ON, 0),
    ("gps_rescue_velocity_p", GpsRescuePids, ("velocity_p",), 0, 200),
    ("gps_rescue_yaw_p", GpsRescuePids, ("yaw_p",), 0, 200),
    ("mag_declination", CompassConfig, ("declination",), -300, 300),
    ("deadband", RcDeadband, ("deadband",), 0, 32),
    ("yaw_deadband", RcDeadband, ("yaw_deadband",), 0, 100),
    ("vtx_band", VtxConfig, ("band",), 0, 8),
    ("vtx_channel", VtxConfig, ("channel",), 0, 8),
    ("vtx_power", VtxConfig, ("power",), 0, 7),
    ("vtx_low_power_disarm", VtxConfig, ("low_power_disarm",), ("OFF", "ON", "UNTIL_FIRST_ARM"), 0),
    ("vtx_freq", VtxConfig, ("frequency",), 0, 5999),
    ("vtx_pit_mode_freq", VtxConfig, ("pit_mode_frequency",), 0, 5999),
    ("osd_units", OsdConfig, ("units",), ("IMPERIAL", "METRIC", "BRITISH"), 0),
    ("osd_rssi_alarm", OsdConfig, ("rssi_alarm",), 0, 100),
    ("osd_cap_alarm", OsdConfig, ("capacity_alarm",), 0, 20000),
    ("osd_alt_alarm", OsdConfig, ("altitude_alarm",), 0, 10000),
)
_PROFILE: Final[tuple[_Field, ...]] = (
    *_same(
        FilterConfig,
        ("dterm_lpf1_type", _LPF, 0),
        ("dterm_lpf1_static_hz", 0, 1000),
        ("dterm_lpf1_dyn_min_hz", 0, 1000),
        ("dterm_lpf1_dyn_max_hz", 0, 1000),
        ("dterm_lpf1_dyn_expo", 0, 10),
        ("dterm_lpf2_type", _LPF, 0),
        ("dterm_lpf2_static_hz", 0, 1000),
        ("dterm_notch_hz", 0, 1000),
        ("dterm_notch_cutoff", 0, 1000),
        ("yaw_lowpass_hz", 0, 500),
    ),
    *(
        (f"{letter}_{axis}", Pid, ("controllers", index, letter), 0, 250)
        for index, axis in ((1, "pitch"), (0, "roll"), (2, "yaw"))
        for letter in "pid"
    ),
    ("f_pitch", PidAdvanced, ("pitch_f",), 0, 1000),
    ("f_roll", PidAdvanced, ("roll_f",), 0, 1000),
    ("f_yaw", PidAdvanced, ("yaw_f",), 0, 1000),
    ("d_min_roll", PidAdvanced, ("d_max_roll",), 0, 250),
    ("d_min_pitch", PidAdvanced, ("d_max_pitch",), 0, 250),
    ("d_min_yaw", PidAdvanced, ("d_max_yaw",), 0, 250),
    ("angle_p_gain", Pid, ("controllers", 3, "p"), 0, 200),
    ("thrust_linear", PidAdvanced, ("thrust_linearization",), 0, 150),
    *_same(
        PidAdvanced,
        ("angle_limit", 10, 80),
        ("anti_gravity_gain", 0, 250),
        ("iterm_relax", ("OFF", "RP", "RPY", "RP_INC", "RPY_INC"), 0),
        ("iterm_relax_type", ("GYRO", "SETPOINT"), 0),
        ("iterm_relax_cutoff", 1, 50),
        ("iterm_rotation", _OFF_ON, 0),
        ("throttle_boost", 0, 100),
        ("d_max_gain", 0, 100),
        ("d_max_advance", 0, 200),
        ("motor_output_limit", 1, 100),
        ("auto_profile_cell_count", 0, 8),
        ("feedforward_transition", 0, 100),
        ("feedforward_averaging", ("OFF", "2_POINT", "3_POINT", "4_POINT"), 0),
        ("feedforward_smooth_factor", 0, 95),
        ("feedforward_jitter_factor", 0, 20),
        ("feedforward_boost", 0, 50),
        ("feedforward_max_rate_limit", 0, 200),
        ("vbat_sag_compensation", 0, 150),
        ("tpa_mode", ("PD", "D"), 0),
        ("tpa_rate", 0, 100),
        ("tpa_breakpoint", 1000, 2000),
    ),
    ("dyn_idle_min_rpm", PidAdvanced, ("dyn_idle_min_rpm",), 0, 200),
    ("simplified_pids_mode", SimplifiedTuning, ("pids_mode",), ("OFF", "RP", "RPY"), 0),
    ("simplified_master_multiplier", SimplifiedTuning, ("master_multiplier",), 0, 200),
    ("simplified_i_gain", SimplifiedTuning, ("i_gain",), 0, 200),
    ("simplified_d_gain", SimplifiedTuning, ("d_gain",), 0, 200),
    ("simplified_pi_gain", SimplifiedTuning, ("pi_gain",), 0, 200),
)
_RATES: Final[tuple[_Field, ...]] = (
    ("thr_mid", RcTuning, ("throttle_mid",), 0, 100),
    ("thr_expo", RcTuning, ("throttle_expo",), 0, 100),
    ("rates_type", RcTuning, ("rates_type",), ("BETAFLIGHT", "RACEFLIGHT", "KISS", "ACTUAL", "QUICK"), 0),
    ("roll_rc_rate", RcTuning, ("rc_rate",), 1, 255),
    ("pitch_rc_rate", RcTuning, ("pitch_rc_rate",), 1, 255),
    ("yaw_rc_rate", RcTuning, ("yaw_rc_rate",), 1, 255),
    ("roll_expo", RcTuning, ("rc_expo",), 0, 100),
    ("pitch_expo", RcTuning, ("pitch_expo",), 0, 100),
    ("yaw_expo", RcTuning, ("yaw_expo",), 0, 100),
    ("roll_srate", RcTuning, ("roll_rate",), 0, 255),
    ("pitch_srate", RcTuning, ("pitch_rate",), 0, 255),
    ("yaw_srate", RcTuning, ("yaw_rate",), 0, 255),
    ("throttle_limit_type", RcTuning, ("throttle_limit_type",), ("OFF", "SCALE", "CLIP"), 0),
    ("throttle_limit_percent", RcTuning, ("throttle_limit_percent",), 25, 100),
    ("roll_rate_limit", RcTuning, ("roll_rate_limit",), 200, 1998),
    ("pitch_rate_limit", RcTuning, ("pitch_rate_limit",), 200, 1998),
    ("yaw_rate_limit", RcTuning, ("yaw_rate_limit",), 200, 1998),
)

PID_PROFILE_KINDS: Final[frozenset[type[MspMessage]]] = frozenset((Pid, PidAdvanced, SimplifiedTuning))
RATE_PROFILE_KINDS: Final[frozenset[type[MspMessage]]] = frozenset((RcTuning,))


def _setting(field: _Field) -> CliSetting:
    name, kind, path, low, high = field
    if isinstance(low, tuple):
        return CliSetting(name, kind, path, 0, 0, low)
    return CliSetting(name, kind, path, low, high)


CLI_SETTINGS: Final = SettingTable(
    (
        *map(_setting, _MASTER),
        CliSetting("craft_name", Name, ("name",), 1, 16, (), is_text=True),
        *named_settings(_NAMED.items()),
        *map(_setting, _PROFILE),
        *map(_setting, _RATES),
    )
)


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
    return SettingFacts(
        INFO, (*MESSAGES, *PERIPHERALS), PID_PROFILE_KINDS, RATE_PROFILE_KINDS, _NAMED, 20, ranges
    )
