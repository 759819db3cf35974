"""The reasons why a flight controller does not arm, in words for status texts.

The firmwares name their reasons by constants; the texts have words and the constant, by which the manuals
explain it. They begin with "PreArm: ", as those of ArduPilot do, so that ground stations show them as failed
checks.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

PREFIX: Final = "PreArm: "

_WORDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        # Betaflight
        "NO_GYRO": "no gyroscope was found",
        "FAILSAFE": "failsafe is active",
        "RX_FAILSAFE": "no RC signal",
        "NOT_DISARMED": "RC signal came back with arm switch on",
        "BOXFAILSAFE": "failsafe switch is on",
        "RUNAWAY_TAKEOFF": "runaway takeoff was prevented",
        "CRASH_DETECTED": "a crash was detected",
        "THROTTLE": "throttle is not low",
        "ANGLE": "not level",
        "BOOT_GRACE_TIME": "still starting",
        "NOPREARM": "prearm switch is off",
        "LOAD": "processor load is too high",
        "CALIBRATING": "calibrating",
        "CLI": "CLI is open",
        "CMS_MENU": "OSD menu is open",
        "BST": "disabled by the OSD",
        "MSP": "disabled by a configurator",
        "PARALYZE": "paralyzed",
        "GPS": "GPS is not ready for rescue",
        "RESC": "GPS rescue switch is on",
        "DSHOT_TELEM": "no telemetry of the motors",
        "REBOOT_REQUIRED": "reboot is needed",
        "DSHOT_BITBANG": "motor output fails",
        "ACC_CALIBRATION": "accelerometer is not calibrated",
        "MOTOR_PROTOCOL": "no motor protocol is set",
        "CRASHFLIP": "crash-flip switch is on",
        "ALTHOLD": "altitude hold switch is on",
        "POSHOLD": "position hold switch is on",
        "AUTOPILOT": "autopilot switch is on",
        "ARM_SWITCH": "arm switch is on",
        # iNav
        "GEOZONE": "inside a forbidden zone",
        "FAILSAFE_SYSTEM": "failsafe is active",
        "NOT_LEVEL": "not level",
        "SENSORS_CALIBRATING": "calibrating",
        "SYSTEM_OVERLOADED": "processor load is too high",
        "NAVIGATION_UNSAFE": "navigation is not safe",
        "COMPASS_NOT_CALIBRATED": "compass is not calibrated",
        "ACCELEROMETER_NOT_CALIBRATED": "accelerometer is not calibrated",
        "HARDWARE_FAILURE": "a sensor fails",
        "BOXKILLSWITCH": "kill switch is on",
        "RC_LINK": "no RC signal",
        "OSD_MENU": "OSD menu is open",
        "ROLLPITCH_NOT_CENTERED": "sticks are not centered",
        "SERVO_AUTOTRIM": "servos are being trimmed",
        "OOM": "out of memory",
        "INVALID_SETTING": "a setting is not valid",
        "PWM_OUTPUT_ERROR": "motor output fails",
        "NO_PREARM": "prearm switch is off",
        "DSHOT_BEEPER": "motors are beeping",
        "LANDING_DETECTED": "landed",
    }
)
#: Reasons that end when the bridge sends RC channels (sticks centered, throttle and switches low).
ENDED_BY_CHANNELS: Final = frozenset(
    {"FAILSAFE", "RX_FAILSAFE", "THROTTLE", "FAILSAFE_SYSTEM", "RC_LINK", "ROLLPITCH_NOT_CENTERED"}
    | {"ARM_SWITCH", "NOT_DISARMED"}
)
#: Reasons that show that a calibration runs.
CALIBRATING: Final = frozenset({"CALIBRATING", "SENSORS_CALIBRATING"})
#: Betaflight adds the arm switch to every other reason, so it is not a separate reason.
_SWITCH: Final = "ARM_SWITCH"


def reason_texts(reasons: Iterable[str]) -> tuple[str, ...]:
    """Return the status texts of reasons, by the names of their constants."""
    names = tuple(reasons)
    shown = names if names == (_SWITCH,) else tuple(name for name in names if name != _SWITCH)
    return tuple(f"{PREFIX}{_WORDS[name]} ({name})" if name in _WORDS else PREFIX + name for name in shown)
