"""Positions in commands and mission items: degrees and metres in Python, scaled integers on the wire.

COMMAND_INT and MISSION_ITEM_INT carry params 5 and 6 as int32: degrees times 1e7 in a global frame, metres
times 1e4 in a local one, and unscaled where the command has no location. INT32_MAX stands for NaN (guide:
commands, mission protocol).
"""

from __future__ import annotations

from functools import cache
from math import inf, isnan, nan

from mavstack.dialects import ardupilotmega, common
from mavstack.dialects.enums import marked_values

UNKNOWN = 0x7FFFFFFF
INT32_MIN = -0x80000000
#: The smallest value that rounds to infinity as a float32.
FLOAT32_OVERFLOW = (2 - 2**-24) * 2.0**127

GLOBAL_FRAMES = frozenset(
    {
        common.MavFrame.GLOBAL,
        common.MavFrame.GLOBAL_RELATIVE_ALT,
        common.MavFrame.GLOBAL_INT,
        common.MavFrame.GLOBAL_RELATIVE_ALT_INT,
        common.MavFrame.GLOBAL_TERRAIN_ALT,
        common.MavFrame.GLOBAL_TERRAIN_ALT_INT,
    }
)


@cache
def commands_with_location() -> frozenset[int]:
    """Return the commands whose params 5 and 6 are a latitude and a longitude, or x and y."""
    return marked_values(ardupilotmega.dialect, "MAV_CMD", "has_location")


@cache
def _known_commands() -> frozenset[int]:
    return frozenset(ardupilotmega.dialect.enum_values("MAV_CMD").values())


def is_known_command(command: int) -> bool:
    """Return whether a number is a MAV_CMD of the official dialects."""
    return command in _known_commands()


def scale_of(command: int, frame: int) -> float:
    """Return the factor of params 5 and 6 of a command in an integer message."""
    if command not in commands_with_location() or frame == common.MavFrame.MISSION:
        return 1.0
    return 1e7 if frame in GLOBAL_FRAMES else 1e4


def to_integer(value: float, scale: float) -> int:
    """Return a coordinate for an integer message; NaN and values out of range become `UNKNOWN`."""
    scaled = value * scale
    if isnan(scaled) or not INT32_MIN <= scaled <= UNKNOWN:
        return UNKNOWN
    return round(scaled)


def from_integer(value: int, scale: float) -> float:
    """Return the coordinate of an integer message; `UNKNOWN` becomes NaN."""
    return nan if value == UNKNOWN and scale != 1.0 else value / scale


def as_float32(value: float) -> float:
    """Return a value for a float32 field; values that are too large become infinite."""
    return value if abs(value) < FLOAT32_OVERFLOW or isnan(value) else inf if value > 0 else -inf
