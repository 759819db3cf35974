"""Reasons why a flight controller does not arm, and the sensors that it has: bits of its status."""

from __future__ import annotations

from enum import IntFlag

_LAST_NAME = "ARM_SWITCH"


class ArmingDisableFlag(IntFlag):
    """Reasons of Betaflight not to arm, without `ARM_SWITCH`, whose bit differs between versions."""

    NO_GYRO = 1 << 0
    FAILSAFE = 1 << 1
    RX_FAILSAFE = 1 << 2
    NOT_DISARMED = 1 << 3
    BOXFAILSAFE = 1 << 4
    RUNAWAY_TAKEOFF = 1 << 5
    CRASH_DETECTED = 1 << 6
    THROTTLE = 1 << 7
    ANGLE = 1 << 8
    BOOT_GRACE_TIME = 1 << 9
    NOPREARM = 1 << 10
    LOAD = 1 << 11
    CALIBRATING = 1 << 12
    CLI = 1 << 13
    CMS_MENU = 1 << 14
    BST = 1 << 15
    MSP = 1 << 16
    PARALYZE = 1 << 17
    GPS = 1 << 18
    RESC = 1 << 19
    DSHOT_TELEM = 1 << 20
    REBOOT_REQUIRED = 1 << 21
    DSHOT_BITBANG = 1 << 22
    ACC_CALIBRATION = 1 << 23
    MOTOR_PROTOCOL = 1 << 24
    CRASHFLIP = 1 << 25
    ALTHOLD = 1 << 26
    POSHOLD = 1 << 27
    AUTOPILOT = 1 << 28


class InavArmingFlag(IntFlag):
    """Arming state of iNav, and its reasons not to arm."""

    ARMED = 1 << 2
    WAS_EVER_ARMED = 1 << 3
    SIMULATOR_MODE_HITL = 1 << 4
    SIMULATOR_MODE_SITL = 1 << 5
    GEOZONE = 1 << 6
    FAILSAFE_SYSTEM = 1 << 7
    NOT_LEVEL = 1 << 8
    SENSORS_CALIBRATING = 1 << 9
    SYSTEM_OVERLOADED = 1 << 10
    NAVIGATION_UNSAFE = 1 << 11
    COMPASS_NOT_CALIBRATED = 1 << 12
    ACCELEROMETER_NOT_CALIBRATED = 1 << 13
    ARM_SWITCH = 1 << 14
    HARDWARE_FAILURE = 1 << 15
    BOXFAILSAFE = 1 << 16
    BOXKILLSWITCH = 1 << 17
    RC_LINK = 1 << 18
    THROTTLE = 1 << 19
    CLI = 1 << 20
    CMS_MENU = 1 << 21
    OSD_MENU = 1 << 22
    ROLLPITCH_NOT_CENTERED = 1 << 23
    SERVO_AUTOTRIM = 1 << 24
    OOM = 1 << 25
    INVALID_SETTING = 1 << 26
    PWM_OUTPUT_ERROR = 1 << 27
    NO_PREARM = 1 << 28
    DSHOT_BEEPER = 1 << 29
    LANDING_DETECTED = 1 << 30


class SensorFlag(IntFlag):
    """Sensors that the flight controller found."""

    ACCELEROMETER = 1 << 0
    BAROMETER = 1 << 1
    MAGNETOMETER = 1 << 2
    GPS = 1 << 3
    RANGEFINDER = 1 << 4
    GYRO = 1 << 5
    OPTICAL_FLOW = 1 << 6
    TEMPERATURE = 1 << 7
    HARDWARE_FAILURE = 1 << 15


FIRST_INAV_REASON = InavArmingFlag.GEOZONE


def betaflight_arming_reasons(flags: int, flag_count: int | None) -> tuple[str, ...]:
    """Return the names of Betaflight's reasons not to arm.

    Args:
        flags: The bits of the status message.
        flag_count: How many flags the version has; the last one is always ARM_SWITCH. None if it is unknown.
    """
    reasons = []
    for bit in range(32):
        if not flags >> bit & 1:
            continue
        if flag_count is not None and bit == flag_count - 1:
            reasons.append(_LAST_NAME)
        else:
            reasons.append(_flag_name(ArmingDisableFlag, bit))
    return tuple(reasons)


def inav_arming_reasons(flags: int) -> tuple[str, ...]:
    """Return the names of iNav's reasons not to arm, without the bits that tell the arming state."""
    first = FIRST_INAV_REASON.bit_length() - 1
    return tuple(_flag_name(InavArmingFlag, bit) for bit in range(first, 32) if flags >> bit & 1)


def _flag_name(flags: type[IntFlag], bit: int) -> str:
    return flags(1 << bit).name or f"FLAG_{bit}"
