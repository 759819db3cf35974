"""ArduPilot's terrain: requests to ground stations, and the answers to TERRAIN_CHECK.

A vehicle that asks for terrain (`TerrainSource.REQUEST`) wants, in this order: the block below it, the eight
around it, home, and around each waypoint of the mission and each rally point. TERRAIN_ENABLE 0 or bit 0 of
TERRAIN_OPTIONS stops the requests; another TERRAIN_SPACING discards what it has. The map survives a reboot,
as on an SD card. Source: ArduPilot, libraries/AP_Terrain.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.frames import GLOBAL_FRAMES
from mavstack.services.mission import PlanType
from mavstack.services.terrain import TerrainCheckServer, TerrainClient, locate, moved
from mavstack.services.terrain.grid import POINTS_EAST, POINTS_NORTH
from mavstack.services.terrain.map import MAX_SPACING
from mavstack.sim.autopilot.item_positions import has_place
from mavstack.sim.autopilot.terrain import ABOVE_GROUND, knows_terrain, terrain_report

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem
    from mavstack.services.parameters import Value
    from mavstack.services.terrain import Position, TerrainMap
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.vehicle import SimulatedVehicle

_WAYPOINTS: Final = frozenset({common.MavCmd.NAV_WAYPOINT, common.MavCmd.NAV_SPLINE_WAYPOINT})
#: Blocks are requested for points this far from the vehicle in each direction, as a share of a block's size.
_NEIGHBOUR: Final = 0.7
#: Blocks are also requested for four points around a waypoint, this many grid points away along each axis.
_AROUND_WAYPOINT: Final = 7
#: Maximum number of blocks for the mission and the rally points, so that the table has room for the blocks
#: around the vehicle.
_MAX_PLANNED: Final = 512
_SPACING: Final = "TERRAIN_SPACING"
_DOWNLOAD_DISABLED: Final = 1


def register_terrain(vehicle: SimulatedVehicle) -> None:
    """Answer TERRAIN_CHECK, and request terrain if the vehicle is to."""
    vehicle.engine.add(TerrainCheckServer(vehicle.address, partial(_checked_report, vehicle.autopilot)))
    terrain = vehicle.terrain
    if terrain is not None:
        _set_spacing(terrain, vehicle.parameters.get(_SPACING, terrain.spacing))
        vehicle.parameters.on_change(_SPACING, partial(_set_spacing, terrain))
        wanted = WantedTerrain(vehicle.autopilot, terrain)
        vehicle.engine.add(TerrainClient(vehicle.address, terrain, wanted.positions, vehicle.now))


def terrain_problems(autopilot: SimulatedAutopilot) -> Iterator[str]:
    """Yield why the terrain of a mission that counts from it prevents arming."""
    vehicle = autopilot.vehicle
    items = vehicle.plans.get(PlanType.MISSION).items
    if vehicle.terrain is None or not any(item.frame in ABOVE_GROUND for item in items):
        return
    if not is_enabled(vehicle):
        yield "terrain disabled"
    elif vehicle.terrain.pending or not knows_terrain(autopilot):
        yield "waiting for terrain data"


def is_enabled(vehicle: SimulatedVehicle) -> bool:
    """Return whether the vehicle uses terrain (TERRAIN_ENABLE)."""
    return bool(vehicle.parameters.get("TERRAIN_ENABLE", 0))


class WantedTerrain:
    """The positions whose terrain a vehicle wants."""

    def __init__(self, autopilot: SimulatedAutopilot, terrain: TerrainMap) -> None:
        self._autopilot, self._terrain = autopilot, terrain
        #: The mission, the rally points and the grid spacing for which `_planned` was computed.
        self._plans: tuple[object, object, int] = (None, None, 0)
        self._planned: list[Position] = []

    def positions(self) -> Iterator[Position]:
        """Yield positions in degrees, the most urgent first; none while the vehicle does not ask."""
        autopilot = self._autopilot
        options = int(autopilot.vehicle.parameters.get("TERRAIN_OPTIONS", 0))
        asks = is_enabled(autopilot.vehicle) and not options & _DOWNLOAD_DISABLED
        if not asks or not autopilot.has_position:
            return
        frame, here, home = autopilot.body.frame, autopilot.body.estimate, autopilot.home_position
        place = frame.to_global(here.north, here.east, 0.0)[:2]
        yield place
        yield from self._neighbours(*place)
        yield frame.to_global(*home)[:2]
        yield from self._places_of_plans()

    def _neighbours(self, latitude: float, longitude: float) -> Iterator[Position]:
        north, east = (_NEIGHBOUR * points * self._terrain.spacing for points in (POINTS_NORTH, POINTS_EAST))
        for x in (-1, 0, 1):
            for y in (-1, 0, 1):
                yield moved(latitude, longitude, x * north, y * east)

    def _places_of_plans(self) -> list[Position]:
        """Return a position in each block that the plans need, computed again when they change."""
        plans, spacing = self._autopilot.vehicle.plans, self._terrain.spacing
        mission, rally = (plans.get(kind).items for kind in (PlanType.MISSION, PlanType.RALLY))
        known_mission, known_rally, known_spacing = self._plans
        if mission is not known_mission or rally is not known_rally or spacing != known_spacing:
            self._plans = mission, rally, spacing
            by_block: dict[object, Position] = {}
            for position in (*_around_waypoints(mission, spacing), *_places(rally)):
                if len(by_block) < _MAX_PLANNED:
                    by_block.setdefault(locate(*position, spacing).block, position)
            self._planned = list(by_block.values())
        return self._planned


def _around_waypoints(items: tuple[MissionItem, ...], spacing: int) -> Iterator[Position]:
    """Yield each waypoint and four points around it."""
    aside = _AROUND_WAYPOINT * spacing
    waypoints = tuple(item for item in items[1:] if item.command in _WAYPOINTS)  # item 0 is home
    for position in _places(waypoints):
        yield position
        for north, east in ((aside, aside), (-aside, aside), (-aside, -aside), (aside, -aside)):
            yield moved(*position, north, east)


def _places(items: tuple[MissionItem, ...]) -> Iterator[Position]:
    for item in items:
        if item.frame in GLOBAL_FRAMES and has_place(item) and abs(item.param5) <= 90:
            yield item.param5, (item.param6 + 180.0) % 360.0 - 180.0


def _checked_report(autopilot: SimulatedAutopilot, latitude: float, longitude: float) -> common.TerrainReport:
    """Return the report of a position, whose terrain the vehicle wants from now on."""
    terrain = autopilot.vehicle.terrain
    if terrain is not None:
        terrain.want(latitude, longitude)
    return terrain_report(autopilot, latitude, longitude)


def _set_spacing(terrain: TerrainMap, value: Value) -> None:
    terrain.spacing = min(max(int(value), 1), MAX_SPACING)
