"""The answers to version requests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.version.protocol_version import ProtocolVersion

if TYPE_CHECKING:
    from mavstack.services.message_request import MessageServer
    from mavstack.services.version.autopilot_version import AutopilotVersion


def provide_versions(
    messages: MessageServer, autopilot: AutopilotVersion, protocol: ProtocolVersion | None = None
) -> None:
    """Answer requests for AUTOPILOT_VERSION and PROTOCOL_VERSION, legacy ones included."""
    supported = protocol or ProtocolVersion()
    messages.provide(common.AutopilotVersion, lambda _: autopilot.to_message())
    messages.provide(common.ProtocolVersion, lambda _: supported.to_message())
