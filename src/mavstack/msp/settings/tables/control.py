"""Settings of Betaflight's controllers and sticks."""

from __future__ import annotations

from functools import partial

from mavstack.msp.messages.pid import BETAFLIGHT_PID_NAMES, Pid, PidAdvanced, SetPid, SetPidAdvanced
from mavstack.msp.messages.rc import RcDeadband, RcTuning, SetRcDeadband, SetRcTuning
from mavstack.msp.settings.definition import define

PID_GAIN_MAX, FEEDFORWARD_MAX = 250, 1000
_MEANINGS = {
    ("LEVEL", "P"): "Strength of the mode ANGLE",
    ("LEVEL", "I"): "Strength of levelling in the mode HORIZON",
    ("LEVEL", "D"): "Deflection of the stick at which the mode HORIZON no longer levels",
}
_TERMS = {"P": "Proportional", "I": "Integral", "D": "Derivative"}

PID = tuple(
    define(
        f"BF_PID_{axis}_{term}",
        f"controllers[{index}].{term.lower()}",
        _MEANINGS.get((axis, term), f"{_TERMS[term]} gain of the controller {axis}"),
        0,
        PID_GAIN_MAX,
        messages=(Pid, SetPid),
        variants=("BTFL",),
    )
    for index, axis in enumerate(BETAFLIGHT_PID_NAMES)
    for term in _TERMS
)

_rc = partial(define, messages=(RcTuning, SetRcTuning), variants=("BTFL",))
_THROTTLE_LIMITS = ("off", "scale", "clip")
_RATES_TYPES = ("Betaflight", "RaceFlight", "KISS", "Actual", "Quick")

RC_TUNING = (
    _rc(
        "BF_RC_RATE",
        "rc_rate",
        "Rate of roll around the middle of the stick",
        1,
        255,
        alias="BF_RATE_RC_RATE",
    ),
    _rc("BF_RC_EXPO", "rc_expo", "Expo of roll", 0, 100, alias="BF_RATE_RC_EXPO"),
    _rc("BF_ROLL_RATE", "roll_rate", "Rate of roll at the end of the stick", 0, 255, alias="BF_RATE_ROLL"),
    _rc(
        "BF_PITCH_RATE", "pitch_rate", "Rate of pitch at the end of the stick", 0, 255, alias="BF_RATE_PITCH"
    ),
    _rc("BF_YAW_RATE", "yaw_rate", "Rate of yaw at the end of the stick", 0, 255, alias="BF_RATE_YAW"),
    _rc("BF_TPA_RATE_OLD", "tpa_rate", "Attenuation of gains at full throttle", 0, 100, until="1.44"),
    _rc(
        "BF_TPA_BREAK_OLD", "tpa_breakpoint", "Throttle at which attenuation begins", 750, 2250, until="1.44"
    ),
    _rc("BF_THR_MID", "throttle_mid", "Position of the throttle's flattest part", 0, 100),
    _rc("BF_THR_EXPO", "throttle_expo", "Expo of the throttle", 0, 100),
    _rc("BF_YAW_EXPO", "yaw_expo", "Expo of yaw", 0, 100, alias="BF_RC_YAW_EXPO"),
    _rc("BF_YAW_RC_RATE", "yaw_rc_rate", "Rate of yaw around the middle of the stick", 1, 255),
    _rc("BF_PITCH_RC_RATE", "pitch_rc_rate", "Rate of pitch around the middle of the stick", 1, 255),
    _rc("BF_PITCH_EXPO", "pitch_expo", "Expo of pitch", 0, 100),
    _rc("BF_THR_LIM_TYPE", "throttle_limit_type", "Kind of the throttle limit", values=_THROTTLE_LIMITS),
    _rc("BF_THR_LIM_PCT", "throttle_limit_percent", "Limit of the throttle", 25, 100),
    _rc("BF_ROLL_RATE_LIM", "roll_rate_limit", "Largest rate of roll", 200, 1998),
    _rc("BF_PITCH_RAT_LIM", "pitch_rate_limit", "Largest rate of pitch", 200, 1998),
    _rc("BF_YAW_RATE_LIM", "yaw_rate_limit", "Largest rate of yaw", 200, 1998),
    _rc("BF_RATES_TYPE", "rates_type", "Formula of the rates", values=_RATES_TYPES),
    _rc("BF_THR_HOVER", "throttle_hover", "Throttle at which the vehicle hovers", 0, 100),
)

_deadband = partial(define, messages=(RcDeadband, SetRcDeadband))

DEADBANDS = (
    _deadband(
        "BF_DEADBAND", "deadband", "Movement of roll and pitch around the middle that does nothing", 0, 32
    ),
    _deadband(
        "BF_YAW_DEADBAND", "yaw_deadband", "Movement of yaw around the middle that does nothing", 0, 100
    ),
    _deadband(
        "BF_3D_DEADB_THR", "throttle_deadband_3d", "Movement of the throttle that stops motors", 1, 100
    ),
)

_advanced = partial(define, messages=(PidAdvanced, SetPidAdvanced))
_RELAX = ("off", "roll and pitch", "all axes", "roll and pitch, increasing", "all axes, increasing")

PID_ADVANCED = (
    _advanced("BF_PID_ROLL_F", "roll_f", "Feedforward gain of roll", 0, FEEDFORWARD_MAX),
    _advanced("BF_PID_PITCH_F", "pitch_f", "Feedforward gain of pitch", 0, FEEDFORWARD_MAX),
    _advanced("BF_PID_YAW_F", "yaw_f", "Feedforward gain of yaw", 0, FEEDFORWARD_MAX),
    _advanced("BF_FF_TRANSITION", "feedforward_transition", "Deflection with full feedforward", 0, 100),
    _advanced(
        "BF_ACCEL_LIMIT", "rate_accel_limit", "Largest acceleration of roll and pitch; 0 for none", 0, 500
    ),
    _advanced("BF_YAW_ACCEL_LIM", "yaw_rate_accel_limit", "Largest acceleration of yaw; 0 for none", 0, 500),
    _advanced("BF_ANGLE_LIMIT", "angle_limit", "Largest angle in the mode ANGLE", 10, 80),
    _advanced(
        "BF_ANTI_GRAV_G", "anti_gravity_gain", "Gain of anti-gravity; 0 for none", 0, 250, since="1.45"
    ),
    _advanced("BF_ITERM_ROT", "iterm_rotation", "Rotation of integral terms with the vehicle"),
    _advanced("BF_ITERM_RELAX", "iterm_relax", "Axes whose integral terms relax", values=_RELAX),
    _advanced("BF_ITERM_RLX_TYP", "iterm_relax_type", "Signal that relaxes", values=("gyro", "setpoint")),
    _advanced("BF_ITERM_RLX_CUT", "iterm_relax_cutoff", "Cutoff of the relaxation", 1, 50),
    _advanced("BF_THR_BOOST", "throttle_boost", "Boost of quick movements of the throttle", 0, 100),
    _advanced("BF_ACRO_TRN_ANGL", "acro_trainer_angle_limit", "Largest angle of the acro trainer", 10, 80),
    *(
        _advanced(
            f"BF_D_MAX_{axis}",
            f"d_max_{axis.lower()}",
            f"Derivative gain of {axis.lower()} in quick movements",
            0,
            PID_GAIN_MAX,
            since="1.47",
        )
        for axis in ("ROLL", "PITCH", "YAW")
    ),
    *(
        _advanced(
            f"BF_D_MIN_{axis}",
            f"d_max_{axis.lower()}",
            f"Derivative gain of {axis.lower()} in slow movements",
            0,
            PID_GAIN_MAX,
            until="1.46",
        )
        for axis in ("ROLL", "PITCH", "YAW")
    ),
    _advanced("BF_D_MAX_GAIN", "d_max_gain", "Sensitivity of the larger derivative gains", 0, 100),
    _advanced(
        "BF_D_MAX_ADVANCE", "d_max_advance", "Share of the stick in the larger derivative gains", 0, 200
    ),
    _advanced("BF_MOTOR_OUT_LIM", "motor_output_limit", "Limit of all motors", 1, 100),
    _advanced(
        "BF_PROF_CELLS", "auto_profile_cell_count", "Cells that choose the profile; 255 all, 0 none", 0, 255
    ),
    _advanced(
        "BF_DYN_IDLE_RPM", "dyn_idle_min_rpm", "Smallest rotational speed of motors; 0 for none", 0, 20000
    ),
    _advanced(
        "BF_FF_AVERAGING", "feedforward_averaging", "Packets of which the mean is taken, less one", 0, 3
    ),
    _advanced("BF_FF_SMOOTH", "feedforward_smooth_factor", "Smoothing of feedforward", 0, 95),
    _advanced("BF_FF_BOOST", "feedforward_boost", "Boost of feedforward by acceleration", 0, 50),
    _advanced("BF_FF_MAX_RATE", "feedforward_max_rate_limit", "Rate at which feedforward ends", 0, 200),
    _advanced("BF_FF_JITTER", "feedforward_jitter_factor", "Reduction of feedforward for slow sticks", 0, 20),
    _advanced("BF_VBAT_SAG_COMP", "vbat_sag_compensation", "Compensation of a falling voltage", 0, 150),
    _advanced("BF_THRUST_LINEAR", "thrust_linearization", "Compensation of the curve of the thrust", 0, 150),
    _advanced(
        "BF_TPA_MODE", "tpa_mode", "Gains that throttle attenuates", values=("P and D", "D", "P, D and S")
    ),
    _advanced("BF_TPA_RATE", "tpa_rate", "Attenuation of gains at full throttle", 0, 100),
    _advanced("BF_TPA_BREAKPT", "tpa_breakpoint", "Throttle at which attenuation begins", 1000, 2000),
)

CONTROL = PID + RC_TUNING + DEADBANDS + PID_ADVANCED
