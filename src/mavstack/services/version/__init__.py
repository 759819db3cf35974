"""The version and capabilities of a component: AUTOPILOT_VERSION and PROTOCOL_VERSION."""

from mavstack.services.version.autopilot_version import AutopilotVersion, FirmwareVersion, git_hash
from mavstack.services.version.client import RequestAutopilotVersion, RequestProtocolVersion
from mavstack.services.version.protocol_version import ProtocolVersion
from mavstack.services.version.server import provide_versions

__all__ = [
    "AutopilotVersion",
    "FirmwareVersion",
    "ProtocolVersion",
    "RequestAutopilotVersion",
    "RequestProtocolVersion",
    "git_hash",
    "provide_versions",
]
