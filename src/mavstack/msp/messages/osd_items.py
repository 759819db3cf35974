"""Items of Betaflight's on-screen display, and where they stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from mavstack.errors import InvalidArgumentError

_OSD_ITEMS_NAMES = """
    RSSI_VALUE MAIN_BATT_VOLTAGE CROSSHAIRS ARTIFICIAL_HORIZON HORIZON_SIDEBARS ITEM_TIMER_1
    ITEM_TIMER_2 FLYMODE CRAFT_NAME THROTTLE_POS VTX_CHANNEL CURRENT_DRAW MAH_DRAWN GPS_SPEED GPS_SATS
    ALTITUDE ROLL_PIDS PITCH_PIDS YAW_PIDS POWER PIDRATE_PROFILE WARNINGS AVG_CELL_VOLTAGE GPS_LON
    GPS_LAT DEBUG PITCH_ANGLE ROLL_ANGLE MAIN_BATT_USAGE DISARMED HOME_DIR HOME_DIST NUMERICAL_HEADING
    NUMERICAL_VARIO COMPASS_BAR ESC_TMP ESC_RPM REMAINING_TIME_ESTIMATE RTC_DATETIME ADJUSTMENT_RANGE
    CORE_TEMPERATURE ANTI_GRAVITY G_FORCE MOTOR_DIAG LOG_STATUS FLIP_ARROW LINK_QUALITY FLIGHT_DIST
    STICK_OVERLAY_LEFT STICK_OVERLAY_RIGHT PILOT_NAME ESC_RPM_FREQ RATE_PROFILE_NAME PID_PROFILE_NAME
    PROFILE_NAME RSSI_DBM_VALUE RC_CHANNELS CAMERA_FRAME EFFICIENCY TOTAL_FLIGHTS UP_DOWN_REFERENCE
    TX_UPLINK_POWER WATT_HOURS_DRAWN AUX_VALUE READY_MODE RSNR_VALUE SYS_GOGGLE_VOLTAGE SYS_VTX_VOLTAGE
    SYS_BITRATE SYS_DELAY SYS_DISTANCE SYS_LQ SYS_GOGGLE_DVR SYS_VTX_DVR SYS_WARNINGS SYS_VTX_TEMP
    SYS_FAN_SPEED GPS_LAP_TIME_CURRENT GPS_LAP_TIME_PREVIOUS GPS_LAP_TIME_BEST3 DEBUG2 CUSTOM_MSG0
    CUSTOM_MSG1 CUSTOM_MSG2 CUSTOM_MSG3 LIDAR_DIST CUSTOM_SERIAL_TEXT BATTERY_PROFILE_NAME
    """
OSD_ITEMS = tuple(_OSD_ITEMS_NAMES.split())
"""Names of the items by their numbers; a firmware may have more, whose numbers depend on its build."""

_AXIS_BITS, _WIDE_BIT, _PROFILE_BIT, _KIND_BIT = 5, 10, 11, 14
_AXIS_MASK, _WIDE_COLUMN = (1 << _AXIS_BITS) - 1, 1 << _AXIS_BITS
PROFILES = (1, 2, 3)


@dataclass(frozen=True, slots=True)
class OsdPosition:
    """Where an item stands, and in which of the three profiles it is shown.

    Attributes:
        column: Column from the left, 0 to 63.
        row: Row from the top, 0 to 31.
        profiles: Profiles that show the item, of 1, 2 and 3; empty if it is hidden.
        kind: Which form of the item is shown, 0 to 3.
    """

    column: int
    row: int
    profiles: tuple[int, ...] = ()
    kind: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.column < 2 * _WIDE_COLUMN or not 0 <= self.row <= _AXIS_MASK:
            raise InvalidArgumentError(
                f"column must be 0 to 63 and row 0 to 31, got {self.column}, {self.row}"
            )
        if not set(self.profiles) <= set(PROFILES) or not 0 <= self.kind <= 3:
            raise InvalidArgumentError(f"profiles must be of 1, 2, 3 and kind 0 to 3, got {self}")

    @classmethod
    def from_bits(cls, bits: int) -> Self:
        """Return the position that a number of MSP_OSD_CONFIG stands for."""
        wide = _WIDE_COLUMN if bits >> _WIDE_BIT & 1 else 0
        profiles = tuple(profile for profile in PROFILES if bits >> (_PROFILE_BIT + profile - 1) & 1)
        return cls(bits & _AXIS_MASK | wide, bits >> _AXIS_BITS & _AXIS_MASK, profiles, bits >> _KIND_BIT & 3)

    def to_bits(self) -> int:
        """Return the number of the position for MSP_SET_OSD_CONFIG."""
        bits = self.column & _AXIS_MASK | self.row << _AXIS_BITS | self.kind << _KIND_BIT
        bits |= (self.column >= _WIDE_COLUMN) << _WIDE_BIT
        for profile in self.profiles:
            bits |= 1 << (_PROFILE_BIT + profile - 1)
        return bits
