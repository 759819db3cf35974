"""The messages that act upon a vehicle: one table for roles, detectors, rules and documentation.

A message acts if a vehicle that accepts it does something, or keeps something, that it would not otherwise.
A program that sends one in the name of another controls the vehicle; one that reaches the wrong vehicle moves
it. Roles refuse all of them to observers, except the carriers of commands, which are judged by their command
(`acts`). Requests for data do not act, nor do corrections that are broadcast to all (GPS_RTCM_DATA).
"""

from __future__ import annotations

from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect
from mavstack.security.roles import Role, command_ids

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message

#: Names of the messages that change something, by the kind of the changed thing.
ACTING: Final[Mapping[str, str]] = MappingProxyType(
    {
        # Commands: the command determines the kind.
        "command": "COMMAND_INT COMMAND_LONG",
        # Messages that move the vehicle, or change how it flies.
        "flight": """
        SET_MODE MANUAL_CONTROL MANUAL_SETPOINT RC_CHANNELS_OVERRIDE SET_ATTITUDE_TARGET
        SET_POSITION_TARGET_LOCAL_NED SET_POSITION_TARGET_GLOBAL_INT SET_ACTUATOR_CONTROL_TARGET
        SET_HOME_POSITION SET_GPS_GLOBAL_ORIGIN FOLLOW_TARGET CHANGE_OPERATOR_CONTROL COMMAND_CANCEL
        """,
        # Messages that change the vehicle's mission, fence or rally points.
        "plan": """
        MISSION_COUNT MISSION_ITEM MISSION_ITEM_INT MISSION_CLEAR_ALL MISSION_SET_CURRENT
        MISSION_WRITE_PARTIAL_LIST SAFETY_SET_ALLOWED_AREA FENCE_POINT RALLY_POINT
        """,
        # Messages that change the vehicle's settings and stored data.
        "settings": """
        PARAM_SET PARAM_MAP_RC LOG_ERASE SERIAL_CONTROL SETUP_SIGNING AUTH_KEY WIFI_CONFIG_AP CELLULAR_CONFIG
        CAN_FRAME CANFD_FRAME CAN_FILTER_MODIFY SET_MAG_OFFSETS DEVICE_OP_WRITE OSD_PARAM_CONFIG
        """,
        # Messages that read or write the vehicle's files, or are forwarded to its devices.
        "files": "FILE_TRANSFER_PROTOCOL TUNNEL V2_EXTENSION",
        # Messages that give the vehicle positions and sensor values.
        "position": """
        HIL_GPS HIL_SENSOR HIL_STATE HIL_STATE_QUATERNION HIL_OPTICAL_FLOW HIL_RC_INPUTS_RAW HIL_CONTROLS
        HIL_ACTUATOR_CONTROLS GPS_INPUT GPS_INJECT_DATA
        """,
        # Messages that move or change the vehicle's payloads.
        "payload": """
        PARAM_EXT_SET GIMBAL_MANAGER_SET_ATTITUDE GIMBAL_MANAGER_SET_PITCHYAW
        GIMBAL_MANAGER_SET_MANUAL_CONTROL GIMBAL_DEVICE_SET_ATTITUDE MOUNT_CONFIGURE MOUNT_CONTROL
        DIGICAM_CONFIGURE DIGICAM_CONTROL GIMBAL_CONTROL GOPRO_SET_REQUEST LED_CONTROL PLAY_TUNE PLAY_TUNE_V2
        """,
    }
)
#: The kinds of messages in `ACTING` that change a flight.
FLIGHT_KINDS: Final = ("flight", "plan", "settings")
_FILES: Final = "FILE_TRANSFER_PROTOCOL"
#: Offset of the opcode in the payload of MAVLink FTP.
_OPCODE_AT: Final = 3
#: Opcodes of CreateFile, WriteFile, RemoveFile, CreateDirectory, RemoveDirectory, OpenFileWO, TruncateFile
#: and Rename.
_WRITING_OPCODES: Final = frozenset({6, 7, 8, 9, 10, 11, 12, 13})


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
    dialect = Dialect.load("all")
    return frozenset(dialect[name].definition.id for name in acting_names(*kinds))


def acts(message: Message) -> bool:
    """Return whether a message acts: commands are judged by what they ask for, MAVLink FTP by its operation.

    Args:
        message: Any message of any dialect.

    Returns:
        True if the vehicle that receives it does or keeps something that it would not otherwise.
    """
    name = type(message).__mavlink_row__[1]
    if name in ACTING["command"].split():
        return int(message.command) not in command_ids(Role.OBSERVE)  # type: ignore[attr-defined]
    if name == _FILES:
        return message.payload[_OPCODE_AT] in _WRITING_OPCODES  # type: ignore[attr-defined]
    return name in _names()


@cache
def _names() -> frozenset[str]:
    return acting_names()
