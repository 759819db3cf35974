"""Requests of versions; both run on the target's `CommandClient`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import MessageTimeout
from mavstack.services.message_request import RequestMessage
from mavstack.services.procedure import Procedure
from mavstack.services.version.autopilot_version import AutopilotVersion
from mavstack.services.version.protocol_version import ProtocolVersion

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.services.operation import Operation


class RequestAutopilotVersion(Procedure[AutopilotVersion]):
    """The request of AUTOPILOT_VERSION: the target's software, hardware and capabilities."""

    timeout_error = MessageTimeout

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("requesting AUTOPILOT_VERSION from", timeout=timeout, idle_timeout=60.0)

    def steps(self) -> Generator[Operation[Any], Any, AutopilotVersion]:
        """Request the message."""
        message: common.AutopilotVersion = yield RequestMessage(common.AutopilotVersion)
        return AutopilotVersion.read(message)


class RequestProtocolVersion(Procedure[ProtocolVersion]):
    """The request of PROTOCOL_VERSION: the MAVLink versions of the target; an answer shows that 2 works."""

    timeout_error = MessageTimeout

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("requesting PROTOCOL_VERSION from", timeout=timeout, idle_timeout=60.0)

    def steps(self) -> Generator[Operation[Any], Any, ProtocolVersion]:
        """Request the message."""
        message: common.ProtocolVersion = yield RequestMessage(common.ProtocolVersion)
        return ProtocolVersion.read(message)
