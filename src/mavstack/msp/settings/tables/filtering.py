"""Settings of Betaflight's filters, gyro and motor outputs."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from mavstack.msp.messages.filters import AdvancedConfig, FilterConfig, SetAdvancedConfig, SetFilterConfig
from mavstack.msp.settings.definition import define

if TYPE_CHECKING:
    from mavstack.msp.messages.layout import TableMessage

LPF_MAX = 1000
_8_BIT_LPF = "gyro_lpf1_static_hz_8"


def _filter_message(current: TableMessage, name: str, value: object) -> TableMessage:
    """Return the filters with another one; the gyro's low pass also stands in a byte that it may not fit."""
    path = FIELDS[name]
    changes = {path: value}
    if path == "gyro_lpf1_static_hz":
        changes[_8_BIT_LPF] = min(int(str(value)), 255)
    return SetFilterConfig.from_message(current, **changes)


_filter = partial(define, messages=(FilterConfig, SetFilterConfig), variants=("BTFL",), build=_filter_message)
_LPF_TYPES = ("PT1", "biquad", "PT2", "PT3")
_HARDWARE_LPF = ("normal", "option 1", "option 2", "experimental")
_PROTOCOLS = {
    0: "PWM",
    1: "Oneshot125",
    2: "Oneshot42",
    3: "Multishot",
    4: "brushed",
    5: "DShot150",
    6: "DShot300",
    7: "DShot600",
    8: "ProShot1000",
    9: "disabled",
    10: "DroneCAN",
}

FILTERS = (
    _filter("BF_GYRO_LPF1_HZ", "gyro_lpf1_static_hz", "Low pass 1 of the gyro; 0 for none", 0, LPF_MAX),
    _filter("BF_GYRO_LPF2_HZ", "gyro_lpf2_static_hz", "Low pass 2 of the gyro; 0 for none", 0, LPF_MAX),
    _filter("BF_GYRO_LPF1_TYP", "gyro_lpf1_type", "Kind of the low pass 1 of the gyro", values=_LPF_TYPES),
    _filter("BF_GYRO_LPF2_TYP", "gyro_lpf2_type", "Kind of the low pass 2 of the gyro", values=_LPF_TYPES),
    _filter("BF_GYRO_DYN_MIN", "gyro_lpf1_dyn_min_hz", "Low pass 1 of the gyro without throttle", 0, LPF_MAX),
    _filter("BF_GYRO_DYN_MAX", "gyro_lpf1_dyn_max_hz", "Low pass 1 of the gyro at full throttle", 0, LPF_MAX),
    _filter("BF_GYRO_HW_LPF", "gyro_hardware_lpf", "Low pass in the gyro itself", values=_HARDWARE_LPF),
    _filter("BF_GYRO_N1_HZ", "gyro_notch1_hz", "Notch 1 of the gyro; 0 for none", 0, LPF_MAX),
    _filter("BF_GYRO_N1_CUT", "gyro_notch1_cutoff", "Lower edge of the notch 1 of the gyro", 0, LPF_MAX),
    _filter("BF_GYRO_N2_HZ", "gyro_notch2_hz", "Notch 2 of the gyro; 0 for none", 0, LPF_MAX),
    _filter("BF_GYRO_N2_CUT", "gyro_notch2_cutoff", "Lower edge of the notch 2 of the gyro", 0, LPF_MAX),
    _filter("BF_DTERM_LPF1_HZ", "dterm_lpf1_static_hz", "Low pass 1 of the D term; 0 for none", 0, LPF_MAX),
    _filter("BF_DTERM_LPF2_HZ", "dterm_lpf2_static_hz", "Low pass 2 of the D term; 0 for none", 0, LPF_MAX),
    _filter("BF_DTERM_LPF1_TY", "dterm_lpf1_type", "Kind of the low pass 1 of the D term", values=_LPF_TYPES),
    _filter("BF_DTERM_LPF2_TY", "dterm_lpf2_type", "Kind of the low pass 2 of the D term", values=_LPF_TYPES),
    _filter(
        "BF_DTERM_DYN_MIN", "dterm_lpf1_dyn_min_hz", "Low pass 1 of the D term without throttle", 0, LPF_MAX
    ),
    _filter(
        "BF_DTERM_DYN_MAX", "dterm_lpf1_dyn_max_hz", "Low pass 1 of the D term at full throttle", 0, LPF_MAX
    ),
    _filter("BF_DTERM_DYN_EXP", "dterm_lpf1_dyn_expo", "Curve of the D term's low pass over throttle", 0, 10),
    _filter("BF_DTERM_N_HZ", "dterm_notch_hz", "Notch of the D term; 0 for none", 0, LPF_MAX),
    _filter("BF_DTERM_N_CUT", "dterm_notch_cutoff", "Lower edge of the notch of the D term", 0, LPF_MAX),
    _filter("BF_YAW_LPF_HZ", "yaw_lowpass_hz", "Low pass of yaw; 0 for none", 0, 500),
    _filter("BF_DYN_N_COUNT", "dyn_notch_count", "Number of dynamic notches for each axis", 0, 7),
    _filter("BF_DYN_N_Q", "dyn_notch_q", "Narrowness of the dynamic notches", 1, 1000),
    _filter("BF_DYN_N_MIN_HZ", "dyn_notch_min_hz", "Lowest frequency of the dynamic notches", 20, 250),
    _filter("BF_DYN_N_MAX_HZ", "dyn_notch_max_hz", "Highest frequency of the dynamic notches", 200, LPF_MAX),
    _filter("BF_RPM_HARMONICS", "rpm_filter_harmonics", "Harmonics of the motors that are filtered", 0, 3),
    _filter("BF_RPM_MIN_HZ", "rpm_filter_min_hz", "Lowest frequency of the RPM filter", 30, 200),
    _filter(
        "BF_RPM_FADE_HZ", "rpm_filter_fade_range_hz", "Range over which the RPM filter fades in", 0, LPF_MAX
    ),
    _filter("BF_RPM_Q", "rpm_filter_q", "Narrowness of the RPM filter", 250, 3000),
    _filter("BF_RPM_WEIGHT1", "rpm_filter_weight_1", "Strength of the filter of the first harmonic", 0, 100),
    _filter("BF_RPM_WEIGHT2", "rpm_filter_weight_2", "Strength of the filter of the second harmonic", 0, 100),
    _filter("BF_RPM_WEIGHT3", "rpm_filter_weight_3", "Strength of the filter of the third harmonic", 0, 100),
)
FIELDS = {item.name: item.path.field for item in FILTERS}

_advanced = partial(define, messages=(AdvancedConfig, SetAdvancedConfig), variants=("BTFL",))

ADVANCED = (
    _advanced("BF_PID_DENOM", "pid_process_denom", "Gyro readings for each control loop", 1, 16),
    _advanced("BF_MOT_UNSYNCED", "use_unsynced_pwm", "Motor pulses with a rate of their own", 0, 1),
    _advanced(
        "BF_MOT_PROTOCOL", "motor_protocol", "Protocol of the motors, of recent versions", values=_PROTOCOLS
    ),
    _advanced("BF_MOT_PWM_RATE", "motor_pwm_rate", "Rate of motor pulses", 200, 32000),
    _advanced("BF_MOTOR_IDLE", "motor_idle", "Throttle of idle motors in hundredths of a percent", 0, 2000),
    _advanced("BF_GYRO_HI_RANGE", "gyro_high_range", "Gyro with twice its range", 0, 1),
    _advanced("BF_GYRO_CAL_NOIS", "gyro_calib_noise_limit", "Noise up to which the gyro calibrates", 0, 200),
    _advanced("BF_GYRO_CAL_TIME", "gyro_calib_duration", "Duration of the gyro's calibration", 0.5, 30.0),
    _advanced("BF_GYRO_OFF_YAW", "gyro_offset_yaw", "Offset of the gyro around yaw", -1000, 1000),
    _advanced(
        "BF_GYRO_OVERFLOW", "gyro_overflow_detect", "Axes watched for overflow", values=("none", "yaw", "all")
    ),
    _advanced("BF_DEBUG_MODE", "debug_mode", "Number of the values for developers", 0, 255),
)

FILTERING = FILTERS + ADVANCED
