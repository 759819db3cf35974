"""Parameters that ArduPilot 4.7 renamed, most of them with another unit.

ArduCopter and ArduSub 4.7 count in metres, degrees and their derivatives, where earlier versions count in
centimetres and centidegrees. A parameter got another name with its new unit; the vehicle converts the stored
value itself. A program that uses such a parameter by name needs both names. The parameters of ArduPlane and
Rover kept theirs, apart from the system ids.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True)
class RenamedParameter:
    """A parameter of ArduPilot before 4.7 and its successor.

    Attributes:
        earlier: The name before 4.7.
        name: The name since 4.7.
        factor: The value since 4.7 divided by the value before.
    """

    earlier: str
    name: str
    factor: float

    @property
    def hint(self) -> str:
        """The text for a program that used the wrong one of the two names."""
        scaled = "" if self.factor == 1.0 else f", {self.factor:g} times the value"
        return f"{self.earlier} is {self.name} since ArduPilot 4.7{scaled}"


_SAME: Final = 1.0
_CENTI: Final = 0.01
_NAMES: Final[Mapping[float, str]] = MappingProxyType(
    {
        _SAME: """
            EK3_MAX_FLOW EK3_FLOW_MAX         PHLD_BRAKE_RATE PHLD_BRK_RATE
            PSC_ACCZ_D PSC_D_ACC_D            PSC_ACCZ_FF PSC_D_ACC_FF
            PSC_JERK_XY PSC_JERK_NE           PSC_JERK_Z PSC_JERK_D
            PSC_POSXY_P PSC_NE_POS_P          PSC_POSZ_P PSC_D_POS_P
            PSC_VELXY_D PSC_NE_VEL_D          PSC_VELXY_I PSC_NE_VEL_I
            PSC_VELXY_P PSC_NE_VEL_P          PSC_VELZ_D PSC_D_VEL_D
            PSC_VELZ_I PSC_D_VEL_I            PSC_VELZ_P PSC_D_VEL_P
            SYSID_MYGCS MAV_GCS_SYSID         SYSID_THISMAV MAV_SYSID
            TELEM_DELAY MAV_TELEM_DELAY       WPNAV_ACCEL_C WP_ACC_CNR
            WPNAV_JERK WP_JERK                WPNAV_RFND_USE WP_RFND_USE
            WPNAV_TER_MARGIN WP_TER_MARGIN
        """,
        _CENTI: """
            ANGLE_MAX ATC_ANGLE_MAX           ATC_ACCEL_P_MAX ATC_ACC_P_MAX
            ATC_ACCEL_R_MAX ATC_ACC_R_MAX     ATC_ACCEL_Y_MAX ATC_ACC_Y_MAX
            ATC_SLEW_YAW ATC_RATE_WPY_MAX     CIRCLE_RADIUS CIRCLE_RADIUS_M
            LAND_ALT_LOW LAND_ALT_LOW_M       LAND_SPEED LAND_SPD_MS
            LAND_SPEED_HIGH LAND_SPD_HIGH_MS  LOIT_ACC_MAX LOIT_ACC_MAX_M
            LOIT_BRK_ACCEL LOIT_BRK_ACC_M     LOIT_BRK_JERK LOIT_BRK_JRK_M
            LOIT_SPEED LOIT_SPEED_MS          PHLD_BRAKE_ANGLE PHLD_BRK_ANGLE
            PILOT_ACCEL_Z PILOT_ACC_Z         PILOT_SPEED_DN PILOT_SPD_DN
            PILOT_SPEED_UP PILOT_SPD_UP       PILOT_TKOFF_ALT PILOT_TKO_ALT_M
            RTL_ALT RTL_ALT_M                 RTL_ALT_FINAL RTL_ALT_FINAL_M
            RTL_CLIMB_MIN RTL_CLIMB_MIN_M     RTL_SPEED RTL_SPEED_MS
            WPNAV_ACCEL WP_ACC                WPNAV_ACCEL_Z WP_ACC_Z
            WPNAV_RADIUS WP_RADIUS_M          WPNAV_SPEED WP_SPD
            WPNAV_SPEED_DN WP_SPD_DN          WPNAV_SPEED_UP WP_SPD_UP
        """,
        0.1: "PSC_ACCZ_I PSC_D_ACC_I PSC_ACCZ_P PSC_D_ACC_P",
    }
)
#: The renamed parameters, by the name that they had before 4.7.
RENAMED: Final[Mapping[str, RenamedParameter]] = MappingProxyType(
    {
        earlier: RenamedParameter(earlier, name, factor)
        for factor, words in _NAMES.items()
        for earlier, name in zip(words.split()[::2], words.split()[1::2], strict=True)
    }
)
_SUCCESSORS: Final[Mapping[str, RenamedParameter]] = MappingProxyType(
    {renamed.name: renamed for renamed in RENAMED.values()}
)


def renaming_of(name: str) -> RenamedParameter | None:
    """Return the renaming of which a name is the earlier or the later one; None if there is none."""
    return RENAMED.get(name) or _SUCCESSORS.get(name)
