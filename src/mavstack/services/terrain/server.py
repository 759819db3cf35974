"""The ground station's side of the terrain protocol: it sends the tiles that vehicles request.

A vehicle repeats its request every two seconds with the mask of the tiles that it still lacks, so nothing is
acknowledged and a lost tile is sent again. On a slow link the requests overtake the tiles: a newer mask
replaces the older one, and sending goes on behind the last tile instead of at the first one, which may still
be on its way. Tiles are bulk data: each is made when the link has room for it, in turn for all vehicles.

A tile of which one height is not known is not sent. Source: guide, Terrain Protocol.
"""

from __future__ import annotations

from collections import OrderedDict
from math import isfinite
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import HasRoom, Outgoing, Priority, Service, always_room
from mavstack.services.terrain.grid import ALL_TILES, Block

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.wire import Packet

#: Returns the height of the terrain at a latitude and longitude in degrees: metres above mean sea level, or
#: None if it is not known.
Heights: TypeAlias = "Callable[[float, float], float | None]"

#: The largest number of vehicles that are served at the same time, and of blocks for each vehicle; beyond
#: them the oldest request is dropped.
MAX_VEHICLES: Final = 256
MAX_BLOCKS: Final = 16
_MIN_HEIGHT, _MAX_HEIGHT = -32_768, 32_767


class _Requests:
    """The requests of one vehicle: by block the tiles to send, and the tile that was sent last."""

    def __init__(self) -> None:
        self.masks: OrderedDict[Block, int] = OrderedDict()
        self._last: dict[Block, int] = {}

    def add(self, block: Block, mask: int) -> None:
        self.masks[block] = mask
        if len(self.masks) > MAX_BLOCKS:
            self._drop(next(iter(self.masks)))

    def take(self) -> tuple[Block, int] | None:
        """Return a block and a tile of it to send; None if nothing is left."""
        while self.masks:
            block, mask = next(iter(self.masks.items()))
            if mask:
                tile = _next_tile(mask, self._last.get(block, -1))
                self._last[block] = tile
                self.masks[block] = mask & ~(1 << tile)
                return block, tile
            del self.masks[block]  # `_last` keeps the last tile of the block for a repeated request
            self._forget_oldest()
        return None

    def _drop(self, block: Block) -> None:
        del self.masks[block]
        self._last.pop(block, None)

    def _forget_oldest(self) -> None:
        if len(self._last) > MAX_BLOCKS:
            del self._last[next(iter(self._last))]


class TerrainServer(Service):
    """Answers TERRAIN_REQUEST of vehicles.

    Args:
        local: The address of the ground station.
        heights: Returns the height of a position. It must return quickly.
    """

    handles = message_ids(common.TerrainRequest)

    def __init__(self, local: Address, heights: Heights) -> None:
        super().__init__(local)
        self._heights = heights
        self._vehicles: OrderedDict[Address, _Requests] = OrderedDict()
        #: The number of tiles sent, and the number of tiles not sent because a height is not known.
        self.sent = self.unknown = 0

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.TerrainRequest(lat=latitude, lon=longitude, grid_spacing=spacing, mask=mask):
                block, vehicle = Block(latitude, longitude, spacing), Address(packet.system, packet.component)
                if block.is_valid and mask & ALL_TILES:
                    self._vehicles.setdefault(vehicle, _Requests()).add(block, mask & ALL_TILES)
                    self._vehicles.move_to_end(vehicle)
                    if len(self._vehicles) > MAX_VEHICLES:
                        self._vehicles.popitem(last=False)
                    return True
        return False

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        waiting = [vehicle for vehicle, requests in self._vehicles.items() if requests.masks]
        while waiting:
            for vehicle in tuple(waiting):
                if not has_room(vehicle) or (message := self._next_message(vehicle)) is None:
                    waiting.remove(vehicle)
                else:
                    yield Outgoing(message, vehicle, Priority.BULK)

    def _next_message(self, vehicle: Address) -> common.TerrainData | None:
        requests = self._vehicles[vehicle]
        while (taken := requests.take()) is not None:
            block, tile = taken
            heights = self._tile(block, tile)
            if heights is not None:
                self.sent += 1
                return common.TerrainData(*block, data=heights, gridbit=tile)
            self.unknown += 1
        return None

    def _tile(self, block: Block, tile: int) -> list[int] | None:
        heights = [self._heights(*position) for position in block.tile_positions(tile)]
        known = [height for height in heights if height is not None and isfinite(height)]
        if len(known) < len(heights):
            return None
        return [min(max(round(height), _MIN_HEIGHT), _MAX_HEIGHT) for height in known]


def _next_tile(mask: int, last: int) -> int:
    """Return the first tile of a mask behind the last one, or from the beginning."""
    behind = mask >> (last + 1) << (last + 1)
    first = behind or mask
    return (first & -first).bit_length() - 1
