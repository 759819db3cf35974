"""Controllers: gains of all axes, feedforward and its limits, and the profiles that hold them."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.fields import Record, items_of, name_list, record, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request

BETAFLIGHT_PID_NAMES = ("ROLL", "PITCH", "YAW", "LEVEL", "MAG")
INAV_PID_NAMES = ("ROLL", "PITCH", "YAW", "ALT", "POS", "POSR", "NAVR", "LEVEL", "MAG", "VEL")


@record
class Gains(Record):
    """Gains of one controller."""

    p: int = u8()
    i: int = u8()
    d: int = u8()


@reply(MspCommand.MSP_PID)
class Pid(TableMessage):
    """Gains of the controllers, in the order of MSP_PIDNAMES."""

    controllers: tuple[Gains, ...] = items_of(Gains)


@request(MspCommand.MSP_SET_PID)
class SetPid(Pid):
    """Set the gains of all controllers."""


@record
class InavGains(Record):
    """Gains of one controller of iNav, with its feedforward."""

    p: int = u8()
    i: int = u8()
    d: int = u8()
    f: int = u8()


@reply(MspCommand.MSP2_PID, INAV_ONLY)
class InavPid(TableMessage):
    """Gains of iNav's controllers, in the order of MSP_PIDNAMES."""

    controllers: tuple[InavGains, ...] = items_of(InavGains)


@request(MspCommand.MSP2_SET_PID, INAV_ONLY)
class SetInavPid(InavPid):
    """Set the gains of all controllers of iNav."""


@reply(MspCommand.MSP_PIDNAMES)
class PidNames(TableMessage):
    """Names of the controllers."""

    names: tuple[str, ...] = name_list()


@reply(MspCommand.MSP_PID_CONTROLLER)
class PidController(TableMessage):
    """Number of the algorithm; 1 is Betaflight's only one."""

    controller: int = u8()


@reply(MspCommand.MSP_PID_ADVANCED, BETAFLIGHT_ONLY)
class PidAdvanced(TableMessage):
    """Feedforward, limits and filters of Betaflight's controllers; fields out of use are 0.

    Before API 1.47 the fields `d_max_…` are the gains of slow movements, and MSP_PID has those of quick ones.
    """

    roll_pitch_iterm_ignore_rate: int = u16()
    yaw_iterm_ignore_rate: int = u16()
    yaw_p_limit: int = u16()
    delta_method: int = u8()
    vbat_pid_compensation: int = u8()
    feedforward_transition: int = u8()
    dterm_setpoint_weight_low: int = u8()
    reserved_1: int = u8()
    reserved_2: int = u8()
    iterm_throttle_gain: int = u8()
    rate_accel_limit: int = u16()
    yaw_rate_accel_limit: int = u16()
    angle_limit: int | None = u8(unit="deg", default=None)
    level_sensitivity: int | None = u8(default=None)
    iterm_throttle_threshold: int | None = u16(default=None)
    anti_gravity_gain: int | None = u16(default=None)
    dterm_setpoint_weight: int | None = u16(default=None)
    iterm_rotation: bool | None = u8(kind=bool, default=None)
    smart_feedforward: int | None = u8(default=None)
    iterm_relax: int | None = u8(default=None)
    iterm_relax_type: int | None = u8(default=None)
    abs_control_gain: int | None = u8(default=None)
    throttle_boost: int | None = u8(default=None)
    acro_trainer_angle_limit: int | None = u8(unit="deg", default=None)
    roll_f: int | None = u16(default=None)
    pitch_f: int | None = u16(default=None)
    yaw_f: int | None = u16(default=None)
    anti_gravity_mode: int | None = u8(default=None)
    d_max_roll: int | None = u8(since="1.41", default=None)
    d_max_pitch: int | None = u8(since="1.41", default=None)
    d_max_yaw: int | None = u8(since="1.41", default=None)
    d_max_gain: int | None = u8(since="1.41", default=None)
    d_max_advance: int | None = u8(since="1.41", default=None)
    use_integrated_yaw: int | None = u8(since="1.41", default=None)
    integrated_yaw_relax: int | None = u8(since="1.41", default=None)
    iterm_relax_cutoff: int | None = u8(unit="Hz", since="1.42", default=None)
    motor_output_limit: int | None = u8(unit="%", since="1.43", default=None)
    auto_profile_cell_count: int | None = u8(since="1.43", default=None)
    dyn_idle_min_rpm: int | None = u8(unit="1/min", step=100, since="1.43", default=None)
    feedforward_averaging: int | None = u8(since="1.44", default=None)
    feedforward_smooth_factor: int | None = u8(since="1.44", default=None)
    feedforward_boost: int | None = u8(since="1.44", default=None)
    feedforward_max_rate_limit: int | None = u8(unit="%", since="1.44", default=None)
    feedforward_jitter_factor: int | None = u8(since="1.44", default=None)
    vbat_sag_compensation: int | None = u8(unit="%", since="1.44", default=None)
    thrust_linearization: int | None = u8(unit="%", since="1.44", default=None)
    tpa_mode: int | None = u8(since="1.45", default=None)
    tpa_rate: int | None = u8(unit="%", since="1.45", default=None)
    tpa_breakpoint: int | None = u16(unit="us", since="1.45", default=None)


@request(MspCommand.MSP_SET_PID_ADVANCED, BETAFLIGHT_ONLY)
class SetPidAdvanced(PidAdvanced):
    """Set feedforward, limits and filters of Betaflight's controllers."""


@request(MspCommand.MSP_SELECT_SETTING)
class SelectSetting(TableMessage):
    """Choose a profile: its index, plus 128 for a rate profile and 64 for a battery profile of Betaflight."""

    profile: int = u8()


@request(MspCommand.MSP_COPY_PROFILE, BETAFLIGHT_ONLY)
class CopyProfile(TableMessage):
    """Copy a profile onto another one: kind 0 a PID profile, 1 a rate profile."""

    kind: int = u8()
    target: int = u8()
    source: int = u8()


@request(MspCommand.MSP_SET_RESET_CURR_PID)
class ResetCurrentPid(TableMessage):
    """Set the active PID profile to the values of the factory."""


@reply(MspCommand.MSP_SIMPLIFIED_TUNING, BETAFLIGHT_ONLY, since="1.44")
class SimplifiedTuning(TableMessage):
    """Sliders by which Betaflight calculates gains and filters, in percent."""

    pids_mode: int = u8()
    master_multiplier: int = u8(unit="%")
    roll_pitch_ratio: int = u8(unit="%")
    i_gain: int = u8(unit="%")
    d_gain: int = u8(unit="%")
    pi_gain: int = u8(unit="%")
    d_max_gain: int = u8(unit="%")
    feedforward_gain: int = u8(unit="%")
    pitch_pi_gain: int = u8(unit="%")
    reserved_1: int = u32()
    reserved_2: int = u32()
    dterm_filter: bool = u8(kind=bool)
    dterm_filter_multiplier: int = u8(unit="%")
    dterm_lpf1_static_hz: int = u16(unit="Hz")
    dterm_lpf2_static_hz: int = u16(unit="Hz")
    dterm_lpf1_dyn_min_hz: int = u16(unit="Hz")
    dterm_lpf1_dyn_max_hz: int = u16(unit="Hz")
    reserved_3: int = u32()
    reserved_4: int = u32()
    gyro_filter: bool = u8(kind=bool)
    gyro_filter_multiplier: int = u8(unit="%")
    gyro_lpf1_static_hz: int = u16(unit="Hz")
    gyro_lpf2_static_hz: int = u16(unit="Hz")
    gyro_lpf1_dyn_min_hz: int = u16(unit="Hz")
    gyro_lpf1_dyn_max_hz: int = u16(unit="Hz")
    reserved_5: int = u32()
    reserved_6: int = u32()


@request(MspCommand.MSP_SET_SIMPLIFIED_TUNING, BETAFLIGHT_ONLY, since="1.44")
class SetSimplifiedTuning(SimplifiedTuning):
    """Set the sliders by which Betaflight calculates gains and filters."""
