"""Heights above the terrain, by the terrain that the vehicle has received from a ground station.

A vehicle without such terrain knows the ground of the simulation, which is flat. With it, the height of the
terrain counts from that at home, as on ArduPilot: the altitude above the terrain at home is the altitude
above home. The ground itself stays flat: a vehicle does not hit a hill that only its map has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

_F = common.MavFrame
#: Frames whose altitudes are above the terrain.
ABOVE_GROUND: Final = frozenset({_F.GLOBAL_TERRAIN_ALT, _F.GLOBAL_TERRAIN_ALT_INT})
#: TERRAIN_REPORT of flat ground: grid spacing in metres, and number of loaded tiles (nine blocks of 56).
_FLAT_SPACING, _FLAT_TILES = 100, 504
_MAX_TILES: Final = 65_535
#: Minimum length in metres of a line, so that the share of the line that is left can be computed.
_MIN_LINE: Final = 1.0


def ground_down(autopilot: SimulatedAutopilot, north: float, east: float) -> float:
    """Return the third local coordinate of the terrain at a place; where it is not known, that of home."""
    if autopilot.vehicle.terrain is None:
        return 0.0
    rise = _rise(autopilot, *autopilot.body.frame.to_global(north, east, 0.0)[:2])
    return autopilot.home_position[2] - (rise or 0.0)


def following(
    autopilot: SimulatedAutopilot, item: MissionItem | None, start: Point, end: Point
) -> Callable[[], float] | None:
    """Return the function of the height on the way to a mission item above the terrain.

    Args:
        autopilot: The autopilot that flies the mission.
        item: The item; None for no item.
        start: The start of the line.
        end: Its end.

    Returns:
        A function that returns the third local coordinate to fly at where the vehicle is; None if the item
        does not count from the terrain, or the vehicle has no map of it.
    """
    flies = autopilot.vehicle.vehicle_type.flies
    if item is None or item.frame not in ABOVE_GROUND or autopilot.vehicle.terrain is None or not flies:
        return None
    first, last = (ground_down(autopilot, *point[:2]) - point[2] for point in (start, end))
    maneuvers = autopilot.maneuvers
    length = max(maneuvers.distance(end), _MIN_LINE)

    def down() -> float:
        left = min(maneuvers.distance(end) / length, 1.0)
        return ground_down(autopilot, *maneuvers.place[:2]) - (last + (first - last) * left)

    return down


def knows_terrain(autopilot: SimulatedAutopilot) -> bool:
    """Return whether the vehicle knows the terrain below it and at home."""
    if autopilot.vehicle.terrain is None:
        return True
    here = autopilot.body.estimate
    latitude, longitude, _ = autopilot.body.frame.to_global(here.north, here.east, 0.0)
    return _rise(autopilot, latitude, longitude) is not None


def terrain_report(autopilot: SimulatedAutopilot, latitude: float, longitude: float) -> common.TerrainReport:
    """Return TERRAIN_REPORT of a position in degrees."""
    terrain, frame, here = autopilot.vehicle.terrain, autopilot.body.frame, autopilot.body.estimate
    place = round(latitude * 1e7), round(longitude * 1e7)
    if terrain is None:
        _, _, altitude = frame.to_global(here.north, here.east, here.down)
        above = altitude - frame.altitude
        return common.TerrainReport(
            *place, _FLAT_SPACING, frame.altitude, above, pending=0, loaded=_FLAT_TILES
        )
    rise = _rise(autopilot, latitude, longitude)
    known = rise is not None
    return common.TerrainReport(
        *place,
        terrain.spacing if known else 0,
        (terrain.height(latitude, longitude) or 0.0) if known else 0.0,
        autopilot.altitude - rise if rise is not None else 0.0,
        pending=min(terrain.pending, _MAX_TILES),
        loaded=min(terrain.loaded, _MAX_TILES),
    )


def _rise(autopilot: SimulatedAutopilot, latitude: float, longitude: float) -> float | None:
    """Return the height of the terrain at a position above that at home, in metres; None if not known."""
    terrain = autopilot.vehicle.terrain
    if terrain is None:
        return 0.0
    north, east, _ = autopilot.home_position
    there = terrain.height(latitude, longitude)
    home = terrain.height(*autopilot.body.frame.to_global(north, east, 0.0)[:2])
    return None if there is None or home is None else there - home
