"""Settings of iNav; controllers have the names of Betaflight's."""

from __future__ import annotations

from functools import partial

from mavstack.msp.messages.battery import InavBatteryConfig, SetInavBatteryConfig
from mavstack.msp.messages.blackbox import InavBlackboxConfig, SetInavBlackboxConfig
from mavstack.msp.messages.config import FeatureConfig, SetFeatureConfig
from mavstack.msp.messages.navigation import (
    FwConfig,
    NavPoshold,
    RthAndLandConfig,
    SetFwConfig,
    SetNavPoshold,
    SetRthAndLandConfig,
)
from mavstack.msp.messages.pid import INAV_PID_NAMES, InavPid, SetInavPid
from mavstack.msp.messages.rc import (
    FailsafeConfig,
    InavRateProfile,
    SetFailsafeConfig,
    SetInavRateProfile,
)
from mavstack.msp.settings.definition import define

_ONLY = ("INAV",)
_TERMS = {"P": "Proportional", "I": "Integral", "D": "Derivative", "F": "Feedforward"}

PID = tuple(
    define(
        f"BF_PID_{axis}_{term}",
        f"controllers[{index}].{term.lower()}",
        f"{_TERMS[term]} gain of the controller {axis}",
        0,
        255,
        messages=(InavPid, SetInavPid),
    )
    for index, axis in enumerate(INAV_PID_NAMES)
    for term in _TERMS
)

_rate = partial(define, messages=(InavRateProfile, SetInavRateProfile))
_failsafe = partial(define, messages=(FailsafeConfig, SetFailsafeConfig), variants=_ONLY)
_battery = partial(define, messages=(InavBatteryConfig, SetInavBatteryConfig))
_hold = partial(define, messages=(NavPoshold, SetNavPoshold))
_rth = partial(define, messages=(RthAndLandConfig, SetRthAndLandConfig))
_wing = partial(define, messages=(FwConfig, SetFwConfig))
_blackbox = partial(define, messages=(InavBlackboxConfig, SetInavBlackboxConfig))
_PROCEDURES = ("landing", "drop", "return to home", "none")

INAV_SETTINGS = (
    *PID,
    _rate("BF_RC_EXPO", "rc_expo", "Expo of roll and pitch", 0, 100, alias="BF_RATE_RC_EXPO"),
    _rate("BF_YAW_EXPO", "yaw_expo", "Expo of yaw", 0, 100, alias="BF_RC_YAW_EXPO"),
    _rate(
        "BF_ROLL_RATE",
        "roll_rate",
        "Rate of roll in tens of degrees per second",
        4,
        180,
        alias="BF_RATE_ROLL",
    ),
    _rate(
        "BF_PITCH_RATE",
        "pitch_rate",
        "Rate of pitch in tens of degrees per second",
        4,
        180,
        alias="BF_RATE_PITCH",
    ),
    _rate(
        "BF_YAW_RATE", "yaw_rate", "Rate of yaw in tens of degrees per second", 1, 180, alias="BF_RATE_YAW"
    ),
    _rate("BF_THR_MID", "throttle_mid", "Position of the throttle's flattest part", 0, 100),
    _rate("BF_THR_EXPO", "throttle_expo", "Expo of the throttle", 0, 100),
    _rate("BF_TPA_RATE", "tpa_rate", "Attenuation of gains at full throttle", 0, 200),
    _rate("BF_TPA_BREAKPT", "tpa_breakpoint", "Throttle at which attenuation begins", 1000, 2000),
    _rate("INAV_MAN_EXPO", "manual_rc_expo", "Expo of roll and pitch in the mode MANUAL", 0, 100),
    _rate("INAV_MAN_YAW_EXP", "manual_yaw_expo", "Expo of yaw in the mode MANUAL", 0, 100),
    _rate("INAV_MAN_ROLL", "manual_roll_rate", "Throw of roll in the mode MANUAL", 0, 100),
    _rate("INAV_MAN_PITCH", "manual_pitch_rate", "Throw of pitch in the mode MANUAL", 0, 100),
    _rate("INAV_MAN_YAW", "manual_yaw_rate", "Throw of yaw in the mode MANUAL", 0, 100),
    _failsafe("BF_FS_DELAY", "delay", "Time without a signal until the vehicle reacts", 0, 20.0),
    _failsafe(
        "BF_FS_LAND_TIME",
        "landing_time",
        "Time of landing until the motors stop, in tenths of a second",
        0,
        200,
    ),
    _failsafe("BF_FS_THROTTLE", "throttle", "Throttle of landing", 1000, 2000),
    _failsafe(
        "BF_FS_THR_DELAY",
        "throttle_low_delay",
        "Time of low throttle after which the vehicle disarms",
        0,
        30.0,
    ),
    _failsafe("BF_FS_PROCEDURE", "procedure", "Reaction to a lost signal", values=_PROCEDURES),
    _failsafe(
        "INAV_FS_RECOVERY", "recovery_delay", "Time with a signal until the pilot has control again", 0, 20.0
    ),
    _failsafe("INAV_FS_ROLL", "fixed_wing_roll", "Roll of an airplane without a signal", -80.0, 80.0),
    _failsafe("INAV_FS_PITCH", "fixed_wing_pitch", "Pitch of an airplane without a signal", -80.0, 80.0),
    _failsafe(
        "INAV_FS_YAW_RATE", "fixed_wing_yaw_rate", "Yaw rate of an airplane without a signal", -1000, 1000
    ),
    _failsafe("INAV_FS_STICK", "stick_threshold", "Movement of a stick that gives control back", 0, 500),
    _failsafe(
        "INAV_FS_MIN_DIST",
        "min_distance",
        "Distance from home below which another reaction applies",
        0,
        650.0,
    ),
    _failsafe(
        "INAV_FS_NEAR", "min_distance_procedure", "Reaction to a lost signal near home", values=_PROCEDURES
    ),
    _battery("BF_BAT_CELL_MIN", "cell_min", "Voltage of an empty cell", 1.0, 5.0),
    _battery("BF_BAT_CELL_MAX", "cell_max", "Voltage of a full cell", 1.0, 5.0),
    _battery("BF_BAT_CELL_WARN", "cell_warning", "Voltage of a cell that gives a warning", 1.0, 5.0),
    _battery("BF_BAT_CAPACITY", "capacity", "Capacity of the battery; 0 if it is unknown", 0, 4294967295),
    _battery(
        "INAV_BAT_DETECT", "cell_detect", "Highest voltage of a cell, from which cells are counted", 1.0, 5.0
    ),
    _battery("INAV_BAT_CELLS", "cell_count", "Number of cells; 0 to count them", 0, 12),
    _battery("INAV_BAT_V_SCALE", "voltage_scale", "Scale of the voltage", 0, 65535),
    _battery(
        "INAV_BAT_I_SCALE",
        "current_scale",
        "Scale of the current in tenths of a millivolt per ampere",
        -10000,
        10000,
    ),
    _battery(
        "INAV_BAT_I_OFFS", "current_offset", "Voltage of the current sensor without a current", -32768, 32767
    ),
    _battery("INAV_BAT_WARN", "capacity_warning", "Charge that is left at the warning", 0, 4294967295),
    _battery("INAV_BAT_CRIT", "capacity_critical", "Charge that is left at the alarm", 0, 4294967295),
    define(
        "BF_FEATURES",
        "features",
        "Features that are switched on, as bits",
        messages=(FeatureConfig, SetFeatureConfig),
        variants=_ONLY,
    ),
    _blackbox("BF_BBOX_DEVICE", "device", "Place of the logs", 0, 4),
    _blackbox(
        "INAV_BBOX_NUM", "rate_numerator", "Numerator of the share of control loops that is logged", 1, 65535
    ),
    _blackbox("INAV_BBOX_DENOM", "rate_denominator", "Denominator of that share", 1, 65535),
    _hold("INAV_CONTROL", "user_control_mode", "Sticks in position hold", values=("attitude", "speed")),
    _hold("INAV_AUTO_SPEED", "max_auto_speed", "Largest speed of missions and return to home", 0.1, 20.0),
    _hold("INAV_AUTO_CLIMB", "max_auto_climb_rate", "Largest vertical speed of missions", 0.1, 20.0),
    _hold("INAV_MAN_SPEED", "max_manual_speed", "Largest speed in position hold", 0.1, 20.0),
    _hold("INAV_MAN_CLIMB", "max_manual_climb_rate", "Largest vertical speed in altitude hold", 0.1, 20.0),
    _hold("INAV_BANK_MC", "max_bank_angle", "Largest angle of a multirotor that navigates", 15, 45),
    _hold(
        "INAV_ALT_THR",
        "altitude_throttle_type",
        "Neutral throttle of altitude hold",
        values=("stick", "mid", "hover"),
    ),
    _hold("INAV_HOVER_THR", "hover_throttle", "Throttle at which a multirotor hovers", 1000, 2000),
    _rth(
        "INAV_RTH_MIN_DST", "min_distance", "Distance from home below which the return lands at once", 0, 50.0
    ),
    _rth("INAV_RTH_CLIMB", "climb_first", "Climb before the way home", values=("no", "yes", "spiral")),
    _rth("INAV_RTH_CL_EMER", "climb_ignore_emergency", "Climb even without a usable altitude"),
    _rth("INAV_RTH_TAIL", "tail_first", "Way home with the tail first"),
    _rth("INAV_RTH_LAND", "allow_landing", "Landing at home", values=("never", "always", "in failsafe")),
    _rth("INAV_RTH_ALT_MOD", "altitude_mode", "Rule for the altitude of the way home", 0, 5),
    _rth(
        "INAV_RTH_ABORT", "abort_threshold", "Growth of the distance from home that ends the return", 0, 655.0
    ),
    _rth("INAV_RTH_ALT", "altitude", "Altitude of the way home", 0, 650.0),
    _rth("INAV_LAND_V_LOW", "land_min_altitude_speed", "Vertical speed of landing at the end", 0.5, 5.0),
    _rth("INAV_LAND_V_HIGH", "land_max_altitude_speed", "Vertical speed of landing at first", 1.0, 20.0),
    _rth(
        "INAV_LAND_A_LOW", "land_slowdown_min_altitude", "Altitude below which the landing is slow", 0.5, 10.0
    ),
    _rth(
        "INAV_LAND_A_HIGH",
        "land_slowdown_max_altitude",
        "Altitude above which the landing is fast",
        5.0,
        40.0,
    ),
    _rth("INAV_EMERG_V", "emergency_descent_rate", "Vertical speed of an emergency landing", 1.0, 20.0),
    _wing("INAV_FW_CRUISE", "cruise_throttle", "Throttle of level flight", 1000, 2000),
    _wing("INAV_FW_THR_MIN", "min_throttle", "Smallest throttle of navigation", 1000, 2000),
    _wing("INAV_FW_THR_MAX", "max_throttle", "Largest throttle of navigation", 1000, 2000),
    _wing("INAV_FW_BANK", "max_bank_angle", "Largest bank angle of navigation", 5, 80),
    _wing("INAV_FW_CLIMB", "max_climb_angle", "Largest climb angle", 5, 80),
    _wing("INAV_FW_DIVE", "max_dive_angle", "Largest dive angle", 5, 80),
    _wing("INAV_FW_P2THR", "pitch_to_throttle", "Throttle for each degree of climb", 0, 100),
    _wing("INAV_FW_LOITER", "loiter_radius", "Radius of circles", 0, 300.0),
)
