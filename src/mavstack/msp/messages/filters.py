"""Filters of the gyro and of the D term, and settings of the gyro and the motor outputs."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.fields import i16, u8, u16
from mavstack.msp.messages.layout import INAV_ONLY, TableMessage, reply, request


@reply(MspCommand.MSP_FILTER_CONFIG)
class FilterConfig(TableMessage):
    """Filters; a frequency of 0 switches a filter off.

    Fields that newer versions do not use are 0.
    """

    gyro_lpf1_static_hz_8: int = u8(unit="Hz")
    dterm_lpf1_static_hz: int = u16(unit="Hz")
    yaw_lowpass_hz: int = u16(unit="Hz")
    gyro_notch1_hz: int = u16(unit="Hz")
    gyro_notch1_cutoff: int = u16(unit="Hz")
    dterm_notch_hz: int = u16(unit="Hz")
    dterm_notch_cutoff: int = u16(unit="Hz")
    gyro_notch2_hz: int | None = u16(unit="Hz", default=None)
    gyro_notch2_cutoff: int | None = u16(unit="Hz", default=None)
    acc_notch_hz: int | None = u16(unit="Hz", variant="INAV", default=None)
    acc_notch_cutoff: int | None = u16(unit="Hz", variant="INAV", default=None)
    gyro_stage2_lowpass_hz: int | None = u16(unit="Hz", variant="INAV", default=None)
    dterm_lpf1_type: int | None = u8(variant="BTFL", default=None)
    gyro_hardware_lpf: int | None = u8(variant="BTFL", default=None)
    gyro_32khz_hardware_lpf: int | None = u8(variant="BTFL", default=None)
    gyro_lpf1_static_hz: int | None = u16(unit="Hz", variant="BTFL", default=None)
    gyro_lpf2_static_hz: int | None = u16(unit="Hz", variant="BTFL", default=None)
    gyro_lpf1_type: int | None = u8(variant="BTFL", default=None)
    gyro_lpf2_type: int | None = u8(variant="BTFL", default=None)
    dterm_lpf2_static_hz: int | None = u16(unit="Hz", variant="BTFL", default=None)
    dterm_lpf2_type: int | None = u8(since="1.41", variant="BTFL", default=None)
    gyro_lpf1_dyn_min_hz: int | None = u16(unit="Hz", since="1.41", variant="BTFL", default=None)
    gyro_lpf1_dyn_max_hz: int | None = u16(unit="Hz", since="1.41", variant="BTFL", default=None)
    dterm_lpf1_dyn_min_hz: int | None = u16(unit="Hz", since="1.41", variant="BTFL", default=None)
    dterm_lpf1_dyn_max_hz: int | None = u16(unit="Hz", since="1.41", variant="BTFL", default=None)
    dyn_notch_range: int | None = u8(since="1.42", variant="BTFL", default=None)
    dyn_notch_width_percent: int | None = u8(since="1.42", variant="BTFL", default=None)
    dyn_notch_q: int | None = u16(since="1.42", variant="BTFL", default=None)
    dyn_notch_min_hz: int | None = u16(unit="Hz", since="1.42", variant="BTFL", default=None)
    rpm_filter_harmonics: int | None = u8(since="1.42", variant="BTFL", default=None)
    rpm_filter_min_hz: int | None = u8(unit="Hz", since="1.42", variant="BTFL", default=None)
    dyn_notch_max_hz: int | None = u16(unit="Hz", since="1.43", variant="BTFL", default=None)
    dterm_lpf1_dyn_expo: int | None = u8(since="1.44", variant="BTFL", default=None)
    dyn_notch_count: int | None = u8(since="1.44", variant="BTFL", default=None)
    rpm_filter_fade_range_hz: int | None = u16(unit="Hz", since="1.48", variant="BTFL", default=None)
    rpm_filter_q: int | None = u16(since="1.48", variant="BTFL", default=None)
    rpm_filter_weight_1: int | None = u8(unit="%", since="1.48", variant="BTFL", default=None)
    rpm_filter_weight_2: int | None = u8(unit="%", since="1.48", variant="BTFL", default=None)
    rpm_filter_weight_3: int | None = u8(unit="%", since="1.48", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_FILTER_CONFIG)
class SetFilterConfig(FilterConfig):
    """Set the filters."""


@reply(MspCommand.MSP_ADVANCED_CONFIG)
class AdvancedConfig(TableMessage):
    """Rate of the control loop, protocol of the motors, and calibration of the gyro.

    `motor_idle` is in hundredths of a percent in Betaflight; iNav has the rate of its servos in its place,
    in Hz.
    """

    gyro_sync_denom: int = u8()
    pid_process_denom: int = u8()
    use_unsynced_pwm: int = u8()
    motor_protocol: int = u8()
    motor_pwm_rate: int = u16(unit="Hz")
    motor_idle: int | None = u16(default=None)
    gyro_sync: int | None = u8(default=None)
    motor_inversion: int | None = u8(variant="BTFL", default=None)
    gyro_to_use: int | None = u8(variant="BTFL", default=None)
    gyro_high_range: int | None = u8(variant="BTFL", default=None)
    gyro_calib_noise_limit: int | None = u8(variant="BTFL", default=None)
    gyro_calib_duration: float | None = u16(100, "s", variant="BTFL", default=None)
    gyro_offset_yaw: int | None = i16(variant="BTFL", default=None)
    gyro_overflow_detect: int | None = u8(variant="BTFL", default=None)
    debug_mode: int | None = u8(since="1.42", variant="BTFL", default=None)
    debug_mode_count: int | None = u8(since="1.42", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_ADVANCED_CONFIG)
class SetAdvancedConfig(TableMessage):
    """Set the rate of the control loop, the protocol of the motors and the calibration of the gyro."""

    gyro_sync_denom: int = u8()
    pid_process_denom: int = u8()
    use_unsynced_pwm: int = u8()
    motor_protocol: int = u8()
    motor_pwm_rate: int = u16(unit="Hz")
    motor_idle: int | None = u16(default=None)
    gyro_sync: int | None = u8(default=None)
    motor_inversion: int | None = u8(variant="BTFL", default=None)
    gyro_to_use: int | None = u8(variant="BTFL", default=None)
    gyro_high_range: int | None = u8(variant="BTFL", default=None)
    gyro_calib_noise_limit: int | None = u8(variant="BTFL", default=None)
    gyro_calib_duration: float | None = u16(100, "s", variant="BTFL", default=None)
    gyro_offset_yaw: int | None = i16(variant="BTFL", default=None)
    gyro_overflow_detect: int | None = u8(variant="BTFL", default=None)
    debug_mode: int | None = u8(since="1.42", variant="BTFL", default=None)


@reply(MspCommand.MSP_LOOP_TIME, INAV_ONLY)
class LoopTime(TableMessage):
    """Interval of iNav's control loop."""

    interval: float = u16(1e6, "s")


@request(MspCommand.MSP_SET_LOOP_TIME, INAV_ONLY)
class SetLoopTime(LoopTime):
    """Set the interval of iNav's control loop."""
