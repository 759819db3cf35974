"""Navigation of iNav: state, missions, safe homes, settings of position hold and return to home."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.fields import i16, i32, u8, u16
from mavstack.msp.messages.layout import INAV_ONLY, TableMessage, reply, request


class NavMode(IntEnum):
    """Activity of the navigation."""

    NONE = 0
    HOLD = 1
    RTH = 2
    NAV = 3
    EMERGENCY = 15


class NavState(IntEnum):
    """Step of the navigation's activity."""

    NONE = 0
    RTH_START = 1
    RTH_ENROUTE = 2
    HOLD_INFINITE = 3
    HOLD_TIMED = 4
    WP_ENROUTE = 5
    PROCESS_NEXT = 6
    DO_JUMP = 7
    LAND_START = 8
    LAND_IN_PROGRESS = 9
    LANDED = 10
    LAND_SETTLE = 11
    LAND_START_DESCENT = 12
    HOVER_ABOVE_HOME = 13
    EMERGENCY_LANDING = 14
    RTH_CLIMB = 15


class NavError(IntEnum):
    """Reason why the navigation cannot go on, or why it waits."""

    NONE = 0
    TOO_FAR = 1
    SPOILED_GPS = 2
    WP_CRC = 3
    FINISH = 4
    TIME_WAIT = 5
    INVALID_JUMP = 6
    INVALID_DATA = 7
    WAIT_FOR_RTH_ALTITUDE = 8
    GPS_FIX_LOST = 9
    DISARMED = 10
    LANDING = 11


class WaypointAction(IntEnum):
    """Action of the vehicle at a waypoint; iNav does not take POSHOLD_UNLIMITED."""

    NONE = 0
    WAYPOINT = 1
    POSHOLD_UNLIMITED = 2
    POSHOLD_TIME = 3
    RTH = 4
    SET_POI = 5
    JUMP = 6
    SET_HEADING = 7
    LAND = 8


LAST_WAYPOINT_FLAG = 0xA5
HOME_WAYPOINT_FLAG = 0x48
HOME_WAYPOINT = 0


@reply(MspCommand.MSP_NAV_STATUS, INAV_ONLY)
class NavStatus(TableMessage):
    """Present state of the navigation."""

    mode: NavMode = u8(kind=NavMode)
    state: NavState = u8(kind=NavState)
    waypoint_action: WaypointAction = u8(kind=WaypointAction)
    waypoint: int = u8()
    error: NavError = u8(kind=NavError)
    target_heading: int = i16(unit="deg")


@reply(MspCommand.MSP_WP_GETINFO, INAV_ONLY)
class WpInfo(TableMessage):
    """Size of the mission, and how many waypoints there can be."""

    capabilities: int = u8()
    max_waypoints: int = u8()
    is_valid: bool = u8(kind=bool)
    waypoint_count: int = u8()


@request(MspCommand.MSP_WP, INAV_ONLY)
class GetWp(TableMessage):
    """Ask for a waypoint, from 1; 0 is home, 254 the present and 255 the desired position."""

    index: int = u8()


@reply(MspCommand.MSP_WP, INAV_ONLY)
class Wp(TableMessage):
    """A waypoint; the meaning of the parameters depends on `action`.

    `parameter_1` is the speed in cm/s of a waypoint, the time in seconds of a hold, or the target of a jump;
    `parameter_2` how often a jump is done, -1 without end; bit 0 of `parameter_3` makes the altitude one
    above sea level instead of home. `flag` is 165 for the last waypoint of a mission.
    """

    index: int = u8()
    action: WaypointAction = u8(kind=WaypointAction)
    latitude: float = i32(1e7, "deg")
    longitude: float = i32(1e7, "deg")
    altitude: float = i32(100, "m")
    parameter_1: int = i16()
    parameter_2: int = i16()
    parameter_3: int = i16()
    flag: int = u8()


@request(MspCommand.MSP_SET_WP, INAV_ONLY)
class SetWp(Wp):
    """Set a waypoint, in order from 1 on; the one with the flag 165 completes the mission."""


@request(MspCommand.MSP_WP_MISSION_LOAD, INAV_ONLY)
class WpMissionLoad(TableMessage):
    """Load the mission that is stored."""

    mission: int = u8(default=0)


@request(MspCommand.MSP_WP_MISSION_SAVE, INAV_ONLY)
class WpMissionSave(TableMessage):
    """Store the mission, so that it is there after a restart."""

    mission: int = u8(default=0)


@request(MspCommand.MSP2_INAV_SET_WP_INDEX, INAV_ONLY)
class SetWpIndex(TableMessage):
    """Go on with another waypoint of the mission that is being flown, from 0."""

    index: int = u8()


@request(MspCommand.MSP2_INAV_SAFEHOME, INAV_ONLY)
class GetSafehome(TableMessage):
    """Ask for a safe home, from 0."""

    index: int = u8()


@reply(MspCommand.MSP2_INAV_SAFEHOME, INAV_ONLY)
class Safehome(TableMessage):
    """A place to which the vehicle returns if it is near the place of arming."""

    index: int = u8()
    is_enabled: bool = u8(kind=bool)
    latitude: float = i32(1e7, "deg")
    longitude: float = i32(1e7, "deg")


@request(MspCommand.MSP2_INAV_SET_SAFEHOME, INAV_ONLY)
class SetSafehome(Safehome):
    """Set a safe home."""


@reply(MspCommand.MSP_NAV_POSHOLD, INAV_ONLY)
class NavPoshold(TableMessage):
    """Settings of position hold."""

    user_control_mode: int = u8()
    max_auto_speed: float = u16(100, "m/s")
    max_auto_climb_rate: float = u16(100, "m/s")
    max_manual_speed: float = u16(100, "m/s")
    max_manual_climb_rate: float = u16(100, "m/s")
    max_bank_angle: int = u8(unit="deg")
    altitude_throttle_type: int = u8()
    hover_throttle: int = u16(unit="us")


@request(MspCommand.MSP_SET_NAV_POSHOLD, INAV_ONLY)
class SetNavPoshold(NavPoshold):
    """Set the settings of position hold."""


@reply(MspCommand.MSP_RTH_AND_LAND_CONFIG, INAV_ONLY)
class RthAndLandConfig(TableMessage):
    """Settings of the return to home and of landings, of iNav 3 and later."""

    min_distance: float = u16(100, "m")
    climb_first: int = u8()
    climb_ignore_emergency: bool = u8(kind=bool)
    tail_first: bool = u8(kind=bool)
    allow_landing: int = u8()
    altitude_mode: int = u8()
    abort_threshold: float = u16(100, "m")
    altitude: float = u16(100, "m")
    land_min_altitude_speed: float = u16(100, "m/s")
    land_max_altitude_speed: float = u16(100, "m/s")
    land_slowdown_min_altitude: float = u16(100, "m")
    land_slowdown_max_altitude: float = u16(100, "m")
    emergency_descent_rate: float = u16(100, "m/s")


@request(MspCommand.MSP_SET_RTH_AND_LAND_CONFIG, INAV_ONLY)
class SetRthAndLandConfig(RthAndLandConfig):
    """Set the settings of the return to home and of landings."""


@reply(MspCommand.MSP_FW_CONFIG, INAV_ONLY)
class FwConfig(TableMessage):
    """Settings of the navigation of airplanes."""

    cruise_throttle: int = u16(unit="us")
    min_throttle: int = u16(unit="us")
    max_throttle: int = u16(unit="us")
    max_bank_angle: int = u8(unit="deg")
    max_climb_angle: int = u8(unit="deg")
    max_dive_angle: int = u8(unit="deg")
    pitch_to_throttle: int = u8(unit="us/deg")
    loiter_radius: float = u16(100, "m")


@request(MspCommand.MSP_SET_FW_CONFIG, INAV_ONLY)
class SetFwConfig(FwConfig):
    """Set the settings of the navigation of airplanes."""


@reply(MspCommand.MSP_POSITION_ESTIMATION_CONFIG, INAV_ONLY)
class PositionEstimationConfig(TableMessage):
    """Weights of barometer and GPS in the estimated position."""

    barometer_altitude: float = u16(100)
    gps_altitude: float = u16(100)
    gps_climb_rate: float = u16(100)
    gps_position: float = u16(100)
    gps_velocity: float = u16(100)
    min_satellites: int = u8()
    use_gps_velocity: bool = u8(kind=bool)


@request(MspCommand.MSP_SET_POSITION_ESTIMATION_CONFIG, INAV_ONLY)
class SetPositionEstimationConfig(PositionEstimationConfig):
    """Set the weights of barometer and GPS in the estimated position."""


@reply(MspCommand.MSP2_INAV_FULL_LOCAL_POSE, INAV_ONLY)
class FullLocalPose(TableMessage):
    """Attitude, and position and velocity from the place of arming, of recent versions."""

    roll: float = i16(10, "deg")
    pitch: float = i16(10, "deg")
    heading: float = i16(10, "deg")
    north: float = i32(100, "m")
    velocity_north: float = i16(100, "m/s")
    east: float = i32(100, "m")
    velocity_east: float = i16(100, "m/s")
    up: float = i32(100, "m")
    velocity_up: float = i16(100, "m/s")


@request(MspCommand.MSP2_INAV_SET_CRUISE_HEADING, INAV_ONLY)
class SetCruiseHeading(TableMessage):
    """Set the course of the mode NAV COURSE HOLD or NAV CRUISE."""

    heading: float = i32(100, "deg")


@request(MspCommand.MSP2_INAV_ARM_DISARM, INAV_ONLY)
class ArmDisarm(TableMessage):
    """Arm, after the usual checks, or disarm, of recent versions."""

    is_armed: bool = u8(kind=bool)


@request(MspCommand.MSP2_INAV_ACTIVATE_RTH, INAV_ONLY)
class ActivateRth(TableMessage):
    """Return to home, of recent versions."""


@request(MspCommand.MSP2_INAV_ACTIVATE_LANDING, INAV_ONLY)
class ActivateLanding(TableMessage):
    """Land at the present position, of recent versions."""


@reply(MspCommand.MSP2_INAV_WIND, INAV_ONLY)
class Wind(TableMessage):
    """Estimated wind, of recent versions; bit 0 of `flags` means that it is known."""

    speed: float = u16(100, "m/s")
    direction: int = u16(unit="deg")
    flags: int = u8()


@reply(MspCommand.MSP2_INAV_MISC2, INAV_ONLY)
class InavMisc2(TableMessage):
    """Times and throttle of iNav."""

    uptime: int = i32(unit="s")
    flight_time: int = i32(unit="s")
    throttle: int = u8(unit="%")
    is_throttle_automatic: bool = u8(kind=bool)
