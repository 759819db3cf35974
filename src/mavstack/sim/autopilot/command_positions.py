"""The position in a command: its params 5 to 7, in any frame.

COMMAND_LONG has no frame; its altitude is above home, as for most commands. A latitude and longitude that are
NaN or both 0 mean the current position, an altitude of NaN the current altitude.
"""

from __future__ import annotations

from math import hypot, isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.refusal import CommandRefusedError
from mavstack.sim.autopilot.terrain import ABOVE_GROUND, ground_down

if TYPE_CHECKING:
    from mavstack.services.command import Command
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

_F = common.MavFrame
#: Frames grouped by the reference of their altitude.
ABOVE_SEA = frozenset({_F.GLOBAL, _F.GLOBAL_INT})
ABOVE_HOME = frozenset({_F.GLOBAL_RELATIVE_ALT, _F.GLOBAL_RELATIVE_ALT_INT})
GLOBAL = ABOVE_SEA | ABOVE_HOME | ABOVE_GROUND
LOCAL = frozenset({_F.LOCAL_NED, _F.LOCAL_OFFSET_NED})

_LATITUDE, _LONGITUDE = 90.0, 180.0
#: Maximum horizontal distance and altitude of a destination, in metres.
_FAR, _HIGH = 2.0e6, 1.0e5


def place_of(
    autopilot: SimulatedAutopilot,
    command: Command,
    *,
    usual: int = _F.GLOBAL_RELATIVE_ALT,
    frames: frozenset[int] = GLOBAL,
    bad_frame: int = common.MavResult.COMMAND_UNSUPPORTED_MAV_FRAME,
) -> Point:
    """Return the position of a command in local metres; raises CommandRefusedError if it is invalid."""
    frame = usual if command.frame is None else command.frame
    if frame not in frames:
        raise CommandRefusedError(bad_frame)
    here = autopilot.maneuvers.place
    if frame in LOCAL:
        point = _local(here, command, offset=frame == _F.LOCAL_OFFSET_NED)
    else:
        north, east = _horizontal(autopilot, command)
        point = north, east, down_of(autopilot, command.param7, frame, (north, east))
    if not all(isfinite(axis) for axis in point) or hypot(*point[:2]) > _FAR or abs(point[2]) > _HIGH:
        raise CommandRefusedError(common.MavResult.DENIED)
    return point


def down_of(
    autopilot: SimulatedAutopilot, altitude: float, frame: int, place: tuple[float, float] | None = None
) -> float:
    """Return an altitude of a frame as the third local coordinate.

    Args:
        autopilot: The autopilot.
        altitude: Metres; NaN means the current altitude.
        frame: The MAV_FRAME.
        place: Metres north and east of the place whose terrain counts; None for the current one.
    """
    if not isfinite(altitude):
        return autopilot.maneuvers.place[2]
    if frame in ABOVE_SEA:
        return autopilot.body.frame.to_local(*_origin(autopilot), altitude)[2]
    if frame in ABOVE_HOME:
        return autopilot.home_position[2] - altitude
    return ground_down(autopilot, *(place or autopilot.maneuvers.place[:2])) - altitude


def has_place(command: Command) -> bool:
    """Return whether a command has a position."""
    given = isfinite(command.param5) and isfinite(command.param6)
    return given and bool(command.param5 or command.param6)


def _origin(autopilot: SimulatedAutopilot) -> tuple[float, float]:
    latitude, longitude, _ = autopilot.body.frame.to_global(0.0, 0.0, 0.0)
    return latitude, longitude


def _horizontal(autopilot: SimulatedAutopilot, command: Command) -> tuple[float, float]:
    if not has_place(command):
        return autopilot.maneuvers.place[:2]
    if abs(command.param5) > _LATITUDE or abs(command.param6) > _LONGITUDE:
        raise CommandRefusedError(common.MavResult.DENIED)
    north, east, _ = autopilot.body.frame.to_local(command.param5, command.param6, 0.0)
    return north, east


def _local(here: Point, command: Command, *, offset: bool) -> Point:
    wanted = (command.param5, command.param6, command.param7)
    if offset:
        return here[0] + wanted[0], here[1] + wanted[1], here[2] + wanted[2]
    return wanted
