"""The messages that act on a vehicle: sent to the wrong one, they move it or change its settings.

All other messages to a vehicle read, answer, or describe the sender.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect
from mavstack.security.roles import Role, command_ids

if TYPE_CHECKING:
    from mavstack.dialects import Message

#: The names of the messages, besides commands and files, which depend on their content.
ACTING_MESSAGES: Final = """
    SET_MODE PARAM_SET PARAM_EXT_SET PARAM_MAP_RC MISSION_WRITE_PARTIAL_LIST MISSION_ITEM MISSION_ITEM_INT
    MISSION_SET_CURRENT MISSION_COUNT MISSION_CLEAR_ALL SET_GPS_GLOBAL_ORIGIN SET_HOME_POSITION COMMAND_CANCEL
    MANUAL_CONTROL RC_CHANNELS_OVERRIDE MANUAL_SETPOINT SET_ATTITUDE_TARGET SET_POSITION_TARGET_LOCAL_NED
    SET_POSITION_TARGET_GLOBAL_INT SET_ACTUATOR_CONTROL_TARGET FOLLOW_TARGET SAFETY_SET_ALLOWED_AREA LOG_ERASE
    CHANGE_OPERATOR_CONTROL SERIAL_CONTROL SETUP_SIGNING PLAY_TUNE PLAY_TUNE_V2 TUNNEL
    GIMBAL_MANAGER_SET_ATTITUDE GIMBAL_MANAGER_SET_PITCHYAW GIMBAL_MANAGER_SET_MANUAL_CONTROL
    GIMBAL_DEVICE_SET_ATTITUDE HIL_CONTROLS HIL_STATE HIL_STATE_QUATERNION HIL_SENSOR HIL_GPS
    HIL_RC_INPUTS_RAW HIL_ACTUATOR_CONTROLS HIL_OPTICAL_FLOW GPS_INPUT SET_MAG_OFFSETS MOUNT_CONFIGURE
    MOUNT_CONTROL DIGICAM_CONFIGURE DIGICAM_CONTROL FENCE_POINT RALLY_POINT GIMBAL_CONTROL GOPRO_SET_REQUEST
    LED_CONTROL DEVICE_OP_WRITE OSD_PARAM_CONFIG
"""
_COMMANDS: Final = ("COMMAND_LONG", "COMMAND_INT")
_FILES: Final = "FILE_TRANSFER_PROTOCOL"
#: The place of the operation in the payload of MAVLink FTP.
_OPCODE_AT: Final = 3
#: CreateFile, WriteFile, RemoveFile, CreateDirectory, RemoveDirectory, OpenFileWO, TruncateFile and Rename.
_WRITING_OPCODES: Final = frozenset({6, 7, 8, 9, 10, 11, 12, 13})


def acts(message: Message) -> bool:
    """Return whether a message changes something on the vehicle that receives it."""
    name = type(message).__mavlink_row__[1]
    if name in _COMMANDS:
        return int(message.command) not in command_ids(Role.OBSERVE)  # type: ignore[attr-defined]
    if name == _FILES:
        return message.payload[_OPCODE_AT] in _WRITING_OPCODES  # type: ignore[attr-defined]
    return name in _names()


@cache
def _names() -> frozenset[str]:
    names = frozenset(ACTING_MESSAGES.split())
    dialect = Dialect.load("all")
    for name in names:
        dialect[name]  # raises for a misspelt name
    return names
