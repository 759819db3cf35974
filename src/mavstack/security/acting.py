"""The messages that act upon a vehicle: one table for roles, detectors, rules and documentation.

A message acts if a vehicle that accepts it does something, or keeps something, that it would not otherwise.
A program that sends one in the name of another controls the vehicle. Roles refuse all of them to observers,
except the carriers of commands, which are judged by their command. Requests for data do not act, nor do
corrections that are broadcast to all receivers (GPS_RTCM_DATA).
"""

from __future__ import annotations

from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect

if TYPE_CHECKING:
    from collections.abc import Mapping

#: Names of the messages by what they act upon.
ACTING: Final[Mapping[str, str]] = MappingProxyType(
    {
        # Carry a command, which decides what they act upon.
        "command": "COMMAND_INT COMMAND_LONG",
        # Move the vehicle, or change how it flies.
        "flight": """
        SET_MODE MANUAL_CONTROL MANUAL_SETPOINT RC_CHANNELS_OVERRIDE SET_ATTITUDE_TARGET
        SET_POSITION_TARGET_LOCAL_NED SET_POSITION_TARGET_GLOBAL_INT SET_ACTUATOR_CONTROL_TARGET
        SET_HOME_POSITION SET_GPS_GLOBAL_ORIGIN FOLLOW_TARGET CHANGE_OPERATOR_CONTROL COMMAND_CANCEL
        """,
        # Change its mission, fence and rally points.
        "plan": """
        MISSION_COUNT MISSION_ITEM MISSION_ITEM_INT MISSION_CLEAR_ALL MISSION_SET_CURRENT
        MISSION_WRITE_PARTIAL_LIST SAFETY_SET_ALLOWED_AREA FENCE_POINT RALLY_POINT
        """,
        # Change its settings and what it stores.
        "settings": """
        PARAM_SET PARAM_MAP_RC LOG_ERASE SERIAL_CONTROL SETUP_SIGNING AUTH_KEY WIFI_CONFIG_AP CELLULAR_CONFIG
        CAN_FRAME CANFD_FRAME CAN_FILTER_MODIFY SET_MAG_OFFSETS DEVICE_OP_WRITE
        """,
        # Read and write its files, and tunnel to its devices.
        "files": "FILE_TRANSFER_PROTOCOL TUNNEL V2_EXTENSION",
        # Tell it where it is.
        "position": """
        HIL_GPS HIL_SENSOR HIL_STATE HIL_STATE_QUATERNION HIL_OPTICAL_FLOW HIL_RC_INPUTS_RAW GPS_INPUT
        GPS_INJECT_DATA
        """,
        # Move and change its payloads.
        "payload": """
        PARAM_EXT_SET GIMBAL_MANAGER_SET_ATTITUDE GIMBAL_MANAGER_SET_PITCHYAW
        GIMBAL_MANAGER_SET_MANUAL_CONTROL GIMBAL_DEVICE_SET_ATTITUDE MOUNT_CONFIGURE MOUNT_CONTROL
        DIGICAM_CONFIGURE DIGICAM_CONTROL GIMBAL_CONTROL GOPRO_SET_REQUEST LED_CONTROL OSD_PARAM_CONFIG
        PLAY_TUNE PLAY_TUNE_V2
        """,
    }
)
#: The kinds of acting messages that change a flight.
FLIGHT_KINDS: Final = ("flight", "plan", "settings")


def acting_names(*kinds: str) -> frozenset[str]:
    """Return the names of the messages that act upon a vehicle.

    Args:
        kinds: Only these kinds; none: all.

    Returns:
        The names.
    """
    return frozenset(name for kind in kinds or ACTING for name in ACTING[kind].split())


@cache
def acting_ids(*kinds: str) -> frozenset[int]:
    """Return the ids of the messages that act upon a vehicle.

    Args:
        kinds: Only these kinds; none: all.

    Returns:
        The ids.
    """
    dialect = Dialect.load("ardupilotmega")
    return frozenset(dialect[name].definition.id for name in acting_names(*kinds))
