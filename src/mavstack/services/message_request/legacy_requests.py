"""Legacy commands that request one message each, older than MAV_CMD_REQUEST_MESSAGE.

They are the second choice of a client, for autopilots that support nothing else, and a server answers them
too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.command import Command


@dataclass(frozen=True, slots=True)
class LegacyRequest:
    """A command that requests one message; `instance` and `flag` are the params that it uses."""

    command: int
    #: The param that carries the index or id (param 2 of MAV_CMD_REQUEST_MESSAGE).
    instance: int | None = None
    #: The param that must be 1.
    flag: int | None = 1

    def to_command(self, instance: float) -> Command:
        """Return the command to send."""
        params = (0.0, 0.0)
        if self.instance is not None:
            params = (instance, 0.0) if self.instance == 1 else (0.0, instance)
        if self.flag is not None:
            params = (1.0, params[1]) if self.flag == 1 else (params[0], 1.0)
        return Command(self.command, params[0], params[1])

    def instance_in(self, command: Command) -> float:
        """Return the index or id in a received command."""
        return 0.0 if self.instance is None else (command.param1, command.param2)[self.instance - 1]


def legacy_request(message_id: int) -> LegacyRequest | None:
    """Return the legacy command that requests a message, if there is one."""
    return _table().get(message_id)


def _entry(kind: type, request: LegacyRequest) -> tuple[int, LegacyRequest]:
    return next(iter(message_ids(kind))), request


@cache
def _table() -> dict[int, LegacyRequest]:
    return dict(
        (
            _entry(common.AutopilotVersion, LegacyRequest(common.MavCmd.REQUEST_AUTOPILOT_CAPABILITIES)),
            _entry(common.ProtocolVersion, LegacyRequest(common.MavCmd.REQUEST_PROTOCOL_VERSION)),
            _entry(common.HomePosition, LegacyRequest(common.MavCmd.GET_HOME_POSITION, flag=None)),
            _entry(common.MessageInterval, LegacyRequest(common.MavCmd.GET_MESSAGE_INTERVAL, 1, flag=None)),
            _entry(common.CameraInformation, LegacyRequest(common.MavCmd.REQUEST_CAMERA_INFORMATION)),
            _entry(common.CameraSettings, LegacyRequest(common.MavCmd.REQUEST_CAMERA_SETTINGS)),
            _entry(common.CameraCaptureStatus, LegacyRequest(common.MavCmd.REQUEST_CAMERA_CAPTURE_STATUS)),
            _entry(
                common.CameraImageCaptured,
                LegacyRequest(common.MavCmd.REQUEST_CAMERA_IMAGE_CAPTURE, 1, flag=None),
            ),
            _entry(common.FlightInformation, LegacyRequest(common.MavCmd.REQUEST_FLIGHT_INFORMATION)),
            _entry(
                common.StorageInformation, LegacyRequest(common.MavCmd.REQUEST_STORAGE_INFORMATION, 1, flag=2)
            ),
            _entry(
                common.VideoStreamInformation,
                LegacyRequest(common.MavCmd.REQUEST_VIDEO_STREAM_INFORMATION, 1, flag=None),
            ),
            _entry(
                common.VideoStreamStatus,
                LegacyRequest(common.MavCmd.REQUEST_VIDEO_STREAM_STATUS, 1, flag=None),
            ),
        )
    )
