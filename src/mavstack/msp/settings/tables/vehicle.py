"""Settings of Betaflight's motors, battery, failsafe, arming, beeper, GPS and blackbox."""

from __future__ import annotations

from functools import partial

from mavstack.msp.messages.battery import BatteryConfig, SetBatteryConfig
from mavstack.msp.messages.blackbox import BlackboxConfig, SetBlackboxConfig
from mavstack.msp.messages.config import (
    ArmingConfig,
    BeeperConfig,
    FeatureConfig,
    SetArmingConfig,
    SetBeeperConfig,
    SetFeatureConfig,
)
from mavstack.msp.messages.gps import (
    GpsConfig,
    GpsRescue,
    GpsRescuePids,
    SetGpsConfig,
    SetGpsRescue,
    SetGpsRescuePids,
)
from mavstack.msp.messages.motors import Motor3dConfig, MotorConfig, SetMotor3dConfig, SetMotorConfig
from mavstack.msp.messages.rc import FailsafeConfig, RssiConfig, SetFailsafeConfig, SetRssiConfig
from mavstack.msp.messages.sensors import (
    AccTrim,
    BoardAlignmentConfig,
    CompassConfig,
    SetAccTrim,
    SetBoardAlignmentConfig,
    SetCompassConfig,
)
from mavstack.msp.settings.definition import define

PULSE_MIN, PULSE_MAX = 750, 2250
CELL_MIN, CELL_MAX = 1.0, 5.0
_ONLY = ("BTFL",)

_motor = partial(define, messages=(MotorConfig, SetMotorConfig))
_3d = partial(define, messages=(Motor3dConfig, SetMotor3dConfig), variants=_ONLY)
_battery = partial(define, messages=(BatteryConfig, SetBatteryConfig))
_failsafe = partial(define, messages=(FailsafeConfig, SetFailsafeConfig), variants=_ONLY)
_arming = partial(define, messages=(ArmingConfig, SetArmingConfig), variants=_ONLY)
_beeper = partial(define, messages=(BeeperConfig, SetBeeperConfig))
_gps = partial(define, messages=(GpsConfig, SetGpsConfig))
_rescue = partial(define, messages=(GpsRescue, SetGpsRescue))
_rescue_pid = partial(define, messages=(GpsRescuePids, SetGpsRescuePids))
_blackbox = partial(define, messages=(BlackboxConfig, SetBlackboxConfig))
_alignment = partial(define, messages=(BoardAlignmentConfig, SetBoardAlignmentConfig), variants=_ONLY)
_trim = partial(define, messages=(AccTrim, SetAccTrim))
_METERS = {0: "none", 1: "ADC", 2: "ESC", 3: "CAN"}
_CURRENT_METERS = {0: "none", 1: "ADC", 2: "virtual", 3: "ESC", 4: "MSP", 5: "CAN"}
_STAGE_1 = ("stage 1", "kill", "stage 2")
_PROCEDURES = ("landing", "drop", "GPS Rescue")
_GPS_PROVIDERS = ("NMEA", "u-blox", "MSP", "virtual", "DroneCAN")
_SBAS = ("automatic", "EGNOS", "WAAS", "MSAS", "GAGAN", "none")
_DEVICES = ("none", "flash", "SD card", "serial port", "virtual")
_RATES = ("every loop", "every 2nd", "every 4th", "every 8th", "every 16th")
_SANITY = ("off", "on", "only in failsafe")
_ALTITUDE_MODES = ("highest", "fixed", "present")

VEHICLE = (
    _motor(
        "BF_MOT_MIN_THR",
        "min_throttle",
        "Smallest pulse of running motors",
        PULSE_MIN,
        PULSE_MAX,
        until="1.46",
    ),
    _motor("BF_MOT_MAX_THR", "max_throttle", "Largest pulse of motors", PULSE_MIN, PULSE_MAX),
    _motor("BF_MOT_MIN_CMD", "min_command", "Pulse of motors that stand still", PULSE_MIN, PULSE_MAX),
    _motor("BF_MOT_POLES", "pole_count", "Number of magnets of a motor", 4, 255),
    _motor("BF_MOT_DSHOT_TLM", "use_dshot_telemetry", "Bidirectional DShot"),
    _3d("BF_3D_DEADB_LOW", "deadband_low", "Pulse of the slowest backward rotation", PULSE_MIN, 1500),
    _3d("BF_3D_DEADB_HIGH", "deadband_high", "Pulse of the slowest forward rotation", 1500, PULSE_MAX),
    _3d("BF_3D_NEUTRAL", "neutral", "Pulse of motors that stand still in 3D", PULSE_MIN, PULSE_MAX),
    _battery("BF_BAT_CELL_MIN", "cell_min", "Voltage of an empty cell", CELL_MIN, CELL_MAX),
    _battery(
        "BF_BAT_CELL_MAX",
        "cell_max",
        "Highest voltage of a cell, from which cells are counted",
        CELL_MIN,
        CELL_MAX,
    ),
    _battery(
        "BF_BAT_CELL_WARN", "cell_warning", "Voltage of a cell that gives a warning", CELL_MIN, CELL_MAX
    ),
    _battery("BF_BAT_CAPACITY", "capacity", "Capacity of the battery; 0 if it is unknown", 0, 20000),
    _battery("BF_BAT_V_SOURCE", "voltage_source", "Source of the voltage", values=_METERS),
    _battery("BF_BAT_I_SOURCE", "current_source", "Source of the current", values=_CURRENT_METERS),
    define(
        "BF_FEATURES",
        "features",
        "Features that are switched on, as bits",
        messages=(FeatureConfig, SetFeatureConfig),
        variants=_ONLY,
    ),
    _failsafe("BF_FS_DELAY", "delay", "Time without a signal until the vehicle reacts", 0.1, 20.0),
    _failsafe("BF_FS_LAND_TIME", "landing_time", "Time of landing until the vehicle disarms", 0, 250),
    _failsafe("BF_FS_THROTTLE", "throttle", "Throttle of landing", PULSE_MIN, PULSE_MAX),
    _failsafe("BF_FS_SWITCH", "switch_mode", "Reaction to the switch FAILSAFE", values=_STAGE_1),
    _failsafe(
        "BF_FS_THR_DELAY",
        "throttle_low_delay",
        "Time of low throttle after which the vehicle disarms",
        0,
        30.0,
    ),
    _failsafe("BF_FS_PROCEDURE", "procedure", "Reaction to a lost signal", values=_PROCEDURES),
    _arming(
        "BF_ARM_DELAY",
        "auto_disarm_delay",
        "Time on the ground until the vehicle disarms; 0 for never",
        0,
        60,
    ),
    _arming("BF_ARM_ANGLE", "small_angle", "Largest angle at which the vehicle arms; 180 for any", 0, 180),
    _arming(
        "BF_ARM_GYRO_CAL", "gyro_cal_on_first_arm", "Calibration of the gyro when the vehicle arms first"
    ),
    _beeper("BF_BEEP_OFF", "off_flags", "Occasions on which the beeper is silent, as bits"),
    _beeper("BF_BEEP_TONE", "dshot_beacon_tone", "Tone of the motors' beacon", 1, 5),
    _beeper("BF_BEEP_DSHOT", "dshot_beacon_off_flags", "Occasions on which the beacon is silent, as bits"),
    _gps("BF_GPS_PROVIDER", "provider", "Protocol of the receiver", values=_GPS_PROVIDERS),
    _gps("BF_GPS_SBAS", "sbas_mode", "Satellites that give corrections", values=_SBAS),
    _gps("BF_GPS_AUTO_CFG", "auto_config", "Configuration of the receiver by the flight controller"),
    _gps("BF_GPS_AUTO_BAUD", "auto_baud", "Search for the baud rate of the receiver"),
    _gps("BF_GPS_HOME_ONCE", "set_home_point_once", "Home at the first place of arming only"),
    _gps("BF_GPS_GALILEO", "ublox_use_galileo", "Use of Galileo by u-blox receivers"),
    _rescue("BF_RESC_ANGLE", "max_angle", "Largest angle of GPS Rescue", 0, 80),
    _rescue("BF_RESC_ALT", "return_altitude", "Altitude of the way home", 5, 1000),
    _rescue("BF_RESC_DESC_DST", "descent_distance", "Distance from home at which the descent begins", 5, 500),
    _rescue("BF_RESC_SPEED", "ground_speed", "Speed over ground of the way home", 0, 30.0),
    _rescue("BF_RESC_THR_MIN", "throttle_min", "Smallest throttle of GPS Rescue", 1000, 2000),
    _rescue("BF_RESC_THR_MAX", "throttle_max", "Largest throttle of GPS Rescue", 1000, 2000),
    _rescue("BF_RESC_THR_HOV", "throttle_hover", "Throttle at which the vehicle hovers", 0, 2000),
    _rescue(
        "BF_RESC_SANITY", "sanity_checks", "When GPS Rescue gives up if it does not work", values=_SANITY
    ),
    _rescue("BF_RESC_MIN_SATS", "min_satellites", "Satellites that arming needs", 5, 50),
    _rescue("BF_RESC_ASCEND", "ascend_rate", "Speed of the climb", 0.5, 25.0),
    _rescue("BF_RESC_DESCEND", "descend_rate", "Speed of the descent", 0.25, 5.0),
    _rescue("BF_RESC_ARM_NFIX", "allow_arming_without_fix", "Arming without a position"),
    _rescue("BF_RESC_ALT_MODE", "altitude_mode", "Altitude of the way home", values=_ALTITUDE_MODES),
    _rescue(
        "BF_RESC_MIN_DIST", "min_start_distance", "Distance from home below which GPS Rescue lands", 0, 1000
    ),
    _rescue("BF_RESC_CLIMB", "initial_climb", "Climb above the present altitude at first", 0, 100),
    _rescue_pid("BF_RESC_ALT_P", "altitude_p", "Proportional gain of altitude", 0, 200),
    _rescue_pid("BF_RESC_ALT_I", "altitude_i", "Integral gain of altitude", 0, 200),
    _rescue_pid("BF_RESC_ALT_D", "altitude_d", "Derivative gain of altitude", 0, 200),
    _rescue_pid(
        "BF_RESC_VEL_P", "velocity_p", "Proportional gain of velocity, or of position since API 1.47", 0, 200
    ),
    _rescue_pid(
        "BF_RESC_VEL_I", "velocity_i", "Integral gain of velocity, or of position since API 1.47", 0, 200
    ),
    _rescue_pid(
        "BF_RESC_VEL_D", "velocity_d", "Derivative gain of velocity, or of position since API 1.47", 0, 200
    ),
    _rescue_pid("BF_RESC_YAW_P", "yaw_p", "Proportional gain of yaw", 0, 200),
    _blackbox("BF_BBOX_DEVICE", "device", "Place of the logs", values=_DEVICES),
    _blackbox("BF_BBOX_RATE", "sample_rate", "Share of the control loops that is logged", values=_RATES),
    _blackbox("BF_BBOX_FLD_OFF", "disabled_fields", "Groups of fields that are not logged, as bits"),
    _alignment("BF_ALIGN_ROLL", "roll", "Rotation of the board around roll", -180, 360),
    _alignment("BF_ALIGN_PITCH", "pitch", "Rotation of the board around pitch", -180, 360),
    _alignment("BF_ALIGN_YAW", "yaw", "Rotation of the board around yaw", -180, 360),
    _trim("BF_TRIM_PITCH", "pitch", "Correction of the level around pitch", -30.0, 30.0),
    _trim("BF_TRIM_ROLL", "roll", "Correction of the level around roll", -30.0, 30.0),
    define(
        "BF_MAG_DECL",
        "declination",
        "Magnetic declination, east positive",
        -30.0,
        30.0,
        messages=(CompassConfig, SetCompassConfig),
    ),
    define(
        "BF_RSSI_CHANNEL",
        "channel",
        "Channel with the strength of the signal; 0 for none",
        0,
        18,
        messages=(RssiConfig, SetRssiConfig),
    ),
)
