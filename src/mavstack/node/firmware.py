"""Firmware differences that the clients of a remote component depend on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.parameters import Encoding, encoding_of

if TYPE_CHECKING:
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.version import AutopilotVersion


def is_ardupilot(info: ComponentInfo | None) -> bool:
    """Return whether the heartbeat is that of ArduPilot."""
    return info is not None and info.autopilot == common.MavAutopilot.ARDUPILOTMEGA


def has_home_item_first(info: ComponentInfo | None) -> bool:
    """Return whether mission item 0 is the home position, as with ArduPilot, and not the first waypoint."""
    return is_ardupilot(info)


def has_packed_params(info: ComponentInfo | None, capabilities: int) -> bool:
    """Return whether all parameters can be downloaded as one packed file, as from ArduPilot with FTP."""
    return is_ardupilot(info) and bool(capabilities & common.MavProtocolCapability.FTP)


def param_encoding(info: ComponentInfo | None, capabilities: int) -> Encoding:
    """Return the encoding of parameter values: of PX4 bytewise, of others by capability or by firmware."""
    if is_px4(info):
        return Encoding.BYTEWISE  # all versions, so that none is asked first
    return encoding_of(capabilities, info.autopilot if info else common.MavAutopilot.GENERIC)


def is_px4(info: ComponentInfo | None) -> bool:
    """Return whether a component is an autopilot with PX4."""
    return info is not None and info.autopilot == common.MavAutopilot.PX4


def saves_at_once(info: ComponentInfo | None) -> bool:
    """Return whether each parameter is saved when it is set, and no command saves them, as on ArduPilot."""
    return is_ardupilot(info)


def saves_by_itself(info: ComponentInfo | None) -> bool:
    """Return whether parameters are saved without a command: at once, or after seconds on PX4."""
    return saves_at_once(info) or is_px4(info)


def firmware_key(info: ComponentInfo | None, version: AutopilotVersion | None) -> str:
    """Return a text that names a firmware: its autopilot, the type of the vehicle, and the version."""
    autopilot, kind = (0, 0) if info is None else (info.autopilot, info.type)
    flight = None if version is None else version.flight
    number = "unknown" if flight is None else f"{flight.major}.{flight.minor}.{flight.patch}"
    return f"firmware-{int(autopilot)}-{int(kind)}-{number}"
