"""Traits of parameters by name: belonging to one vehicle, order of setting, effect after a reboot only.

The names are those of ArduPilot 4 and PX4, as `fnmatch` patterns. A file from another vehicle must not change
this one's sensors, calibration, counters or id, so these are skipped by default. The parameters that need a
reboot come from the firmwares' parameter documentation; the list is not complete, as boards and drivers add
to it.
"""

from __future__ import annotations

import re
from enum import Enum
from fnmatch import translate
from functools import cache
from typing import Final

from mavstack.services.identity import ALL_IDENTITY_PARAMETERS

_COUNTED = """
    STAT_BOOTCNT STAT_FLTTIME STAT_FLTCNT STAT_RUNTIME STAT_RESET STAT_DISTFLWN
    SYS_NUM_RESETS LOG_LASTFILE FORMAT_VERSION SYSID_SW_MREV SYSID_SW_TYPE
    CMD_INDEX CMD_TOTAL WP_TOTAL MIS_TOTAL FENCE_TOTAL RALLY_TOTAL
    GND_ABS_PRESS* GND_TEMP BARO?_GND_PRESS BARO_GND_TEMP
    LND_FLIGHT_T_HI LND_FLIGHT_T_LO COM_FLIGHT_UUID SYS_PARAM_VER
"""
_IDENTITY = " ".join(ALL_IDENTITY_PARAMETERS)
_CALIBRATION = """
    COMPASS_DEV_ID* COMPASS_PRIO?_ID COMPASS_OFS*_? COMPASS_DIA*_? COMPASS_ODI*_? COMPASS_MOT*_?
    COMPASS_SCALE*
    INS_ACC*_ID INS_GYR*_ID INS?_ACC*_ID INS?_GYR*_ID INS_ACC*OFFS_? INS_ACC*SCAL_? INS_GYR*OFFS_?
    INS*_ACC*OFFS_? INS*_ACC*SCAL_? INS*_GYR*OFFS_? INS_*_CALTEMP INS_TCAL?_* AHRS_TRIM_?
    BARO?_DEVID ARSPD*_DEVID ARSPD*_OFFSET GPS_CAN_NODEID? GPS?_CAN_NODEID TCAL_TEMP_* TCAL_BARO_EXP
    CAL_* TC_?_ID TC_??_*
"""
_FIRST = "*_ENABLE *_ENABLED SYS_AUTOSTART FRAME_CLASS *_TYPE *_MONITOR *_PROTOCOL UAVCAN_ENABLE"
_REBOOT = """
    ADSB_LIST_MAX ADSB_TYPE AIS_TYPE BATT*_CURR_PIN BATT*_MONITOR BATT*_VOLT_PIN BRD_* CAM_FEEDBACK_PIN CAN_*
    COMPASS_CUS_* COMPASS_ENABLE COMPASS_PRIO?_ID EK?_AFFINITY EK?_*_DELAY EK?_*_MASK EK?_ENABLE EK?_MAG_CAL
    FLOW_TYPE FRAME_CLASS FRAME_CONFIG FRAME_TYPE GPS_COM_PORT* GPS_DELAY_MS* GPS_RAW_DATA GPS_TYPE* GPS?_TYPE
    INS_GYRO_RATE INS_HNT*_HMNCS INS_HNT*_OPTS INS_HNT*_REF INS_LOG_BAT_* INS_TCAL?_ENABLE LEAK?_PIN MNT*_TYPE
    MOT_PWM_FREQ MOT_PWM_TYPE NTF_LED_LEN OA_DB_* OSD_FONT OSD_TYPE PRX*_TYPE Q_ENABLE Q_M_PWM_TYPE
    Q_TAILSIT_ENABLE Q_TILT_ENABLE RCMAP_* SAIL_ENABLE SCHED_LOOP_RATE SCR_DIR_DISABLE SCR_ENABLE
    SCR_HEAP_SIZE SERIAL*_OPTIONS SERIAL*_PROTOCOL SERVO_BLH_* SERVO_FTW_MASK SERVO_GPIO_MASK SRTL_POINTS
    TRQD_* WNDVN_*TYPE NET_ENABLE
    ADSB_* ASPD_PRIMARY BATMON_* CAM_CAP_* CANNODE_* CBRK_BUZZER CYPHAL_* EKF2_*_DELAY EKF2_*_INIT
    EKF2_MULTI_* EKF2_DELAY_MAX EKF2_REQ_GPS_H GPS_UBX_* GPS_SAT_INFO IMU_GYRO_RATEMAX IMU_GYRO_FFT_EN
    IMU_GYRO_CAL_EN MAV_?_CONFIG MAV_?_FORWARD MAV_?_FLOW_CTRL MAV_?_UDP_PRT MAV_?_REMOTE_PRT MAV_SYS_ID
    MAV_COMP_ID MAV_TYPE PPS_CAP_* RPM_CAP_ENABLE SDLOG_BACKEND SDLOG_PROFILE SENS_EN_* SENS_IMU_MODE
    SENS_MAG_MODE SER_*_BAUD SYS_AUTOSTART SYS_HAS_* SYS_DM_BACKEND SYS_FAILURE_EN SYS_USB_AUTO TC_?_ENABLE
    TRIG_* UAVCAN_* UXRCE_DDS_* VT_TYPE ZENOH_ENABLE
"""


class Owner(Enum):
    """The reason why a parameter belongs to one vehicle only; the value is its text."""

    COUNTER = "the vehicle counts or measures it itself"
    IDENTITY = "it is the id of one vehicle"
    CALIBRATION = "it belongs to the sensors of one vehicle"


_OWNERS: Final = ((Owner.COUNTER, _COUNTED), (Owner.IDENTITY, _IDENTITY), (Owner.CALIBRATION, _CALIBRATION))


def owned_patterns() -> dict[Owner, tuple[str, ...]]:
    """Return the `fnmatch` patterns of parameters that belong to one vehicle only, by the reason for it."""
    return {owner: tuple(patterns.split()) for owner, patterns in _OWNERS}


def owner_of(name: str) -> Owner | None:
    """Return why a parameter belongs to one vehicle only; None if it may be set on any."""
    return next((owner for owner, patterns in _OWNERS if _matches(patterns, name)), None)


def round_of(name: str) -> int:
    """Return the round in which a parameter is set: those that reveal others first, the system id last."""
    if owner_of(name) is Owner.IDENTITY:
        return 2
    return 0 if _matches(_FIRST, name) else 1


def needs_reboot(name: str) -> bool:
    """Return whether a new value is known to take effect after a reboot only."""
    return _matches(_REBOOT, name)


def _matches(patterns: str, name: str) -> bool:
    return bool(_compiled(patterns).fullmatch(name.upper()))


@cache
def _compiled(patterns: str) -> re.Pattern[str]:
    return re.compile("|".join(map(translate, patterns.split())))
