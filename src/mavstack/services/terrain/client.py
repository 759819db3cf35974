"""The vehicle's side of the terrain protocol: it requests tiles, keeps them, and tells what it has.

`TerrainClient` sends one TERRAIN_REQUEST every two seconds while tiles are missing, for one block: that of
the first wanted position that lacks tiles (the vehicle's own comes first), then any other block of the map.
Lost tiles are in the mask of a later request. No ground station is chosen: the request goes to all.

`TerrainCheckServer` answers TERRAIN_CHECK. Source: guide, Terrain Protocol; ArduPilot, libraries/AP_Terrain.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service
from mavstack.services.terrain.grid import Block, locate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.services.terrain.map import TerrainMap
    from mavstack.wire import Packet

#: Seconds between two requests.
REQUEST_INTERVAL: Final = 2.0
#: A latitude and a longitude in degrees.
Position: TypeAlias = tuple[float, float]
#: Makes the TERRAIN_REPORT of a position in degrees.
Reporter: TypeAlias = "Callable[[float, float], common.TerrainReport]"


@dataclass(frozen=True, slots=True)
class TerrainBlockLoaded(Event):
    """All tiles of a block have arrived."""

    block: Block


class TerrainClient(Service):
    """Requests the terrain that a vehicle lacks.

    Args:
        local: The address of the vehicle.
        terrain: The map that the tiles are stored in.
        wanted: Returns the positions whose terrain the vehicle needs now, the most urgent first; none stops
            the requests.
        now: The time of the first request, Unix seconds.
    """

    handles = message_ids(common.TerrainData)

    def __init__(
        self, local: Address, terrain: TerrainMap, wanted: Callable[[], Iterable[Position]], now: float = 0.0
    ) -> None:
        super().__init__(local)
        self.terrain = terrain
        self._wanted = wanted
        self._due = now

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.TerrainData(lat=latitude, lon=longitude, grid_spacing=spacing) as data:
                block = Block(latitude, longitude, spacing)
                added = self.terrain.store(block, data.gridbit, data.data)
                if added and not self.terrain.missing(block):
                    self.emit(TerrainBlockLoaded(block))
                    return True
        return False

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        self._due = now + REQUEST_INTERVAL
        block = self._next_block()
        if block is not None:
            self.send(common.TerrainRequest(*block, mask=self.terrain.missing(block)))

    def _next_block(self) -> Block | None:
        """Return the block to request; None if nothing is missing or wanted."""
        wanted = list(self._wanted())
        lacking = [position for position in wanted if self.terrain.want(*position)]
        if lacking:
            return locate(*lacking[0], self.terrain.spacing).block
        return next(self.terrain.incomplete(), None) if wanted else None


class TerrainCheckServer(Service):
    """Answers TERRAIN_CHECK with a TERRAIN_REPORT of the position that was asked for.

    Args:
        local: The address of the vehicle.
        report: Makes the report.
    """

    handles = message_ids(common.TerrainCheck)

    def __init__(self, local: Address, report: Reporter) -> None:
        super().__init__(local)
        self._report = report

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.TerrainCheck(lat=latitude, lon=longitude):
                if Block(latitude, longitude, 1).is_valid:
                    report = self._report(latitude / 1e7, longitude / 1e7)
                    answer = report.replace(lat=latitude, lon=longitude)
                    self.send(answer, Address(packet.system, packet.component))
