"""The difference between periodic messages and those that are sent on an event or as an answer.

A program that waits for an event waits until it happens. A message that is sent only as an answer is
requested once, by MAV_CMD_REQUEST_MESSAGE.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.services.addressing import message_ids

if TYPE_CHECKING:
    from mavstack.dialects import Message

_ANSWERS: Final = message_ids(
    *(common.AutopilotVersion, common.ProtocolVersion, common.ComponentInformation, common.ComponentMetadata),
    *(common.AvailableModes, common.CameraInformation),
)
_NOT_PERIODIC: Final = _ANSWERS | message_ids(
    *(common.Heartbeat, common.Statustext, common.Event, common.CurrentEventSequence),
    *(common.CommandAck, common.CommandLong, common.CommandInt, common.CommandCancel, common.MessageInterval),
    *(common.ParamValue, common.ParamSet, common.ParamExtValue, common.ParamExtAck, common.ParamRequestRead),
    *(common.MissionAck, common.MissionCount, common.MissionItem, common.MissionItemInt),
    *(common.MissionRequest, common.MissionRequestInt, common.MissionRequestList, common.MissionItemReached),
    *(common.FileTransferProtocol, common.LogEntry, common.LogData, common.SerialControl, common.Tunnel),
    *(common.LoggingData, common.LoggingDataAcked, common.V2Extension, common.EncapsulatedData),
    *(common.AvailableModesMonitor, common.MagCalReport),
    *(common.CameraTrigger, common.CameraImageCaptured, common.Collision),
    *(common.AdsbVehicle, common.AisVessel, common.Ping, common.RadioStatus, common.DataStream),
    *(common.NamedValueFloat, common.NamedValueInt, common.Debug, common.DebugVect, common.HighLatency2),
    *(ardupilotmega.MagCalProgress, ardupilotmega.CameraFeedback, ardupilotmega.Radio),
)


def is_answer(message: type[Message]) -> bool:
    """Return whether a message is sent only when it is requested."""
    return message.__mavlink_row__[0] in _ANSWERS


def is_periodic(message: type[Message]) -> bool:
    """Return whether a message can be requested at a rate."""
    return message.__mavlink_row__[0] not in _NOT_PERIODIC
