"""The terrain protocol: vehicles request heights, ground stations serve them, and check what arrived."""

from mavstack.services.terrain.check import CheckTerrain, TerrainCheckClient, TerrainState, WaitForTerrain
from mavstack.services.terrain.client import Position, TerrainBlockLoaded, TerrainCheckServer, TerrainClient
from mavstack.services.terrain.grid import Block, locate, moved
from mavstack.services.terrain.map import TerrainMap
from mavstack.services.terrain.server import Heights, TerrainServer

__all__ = [
    "Block",
    "CheckTerrain",
    "Heights",
    "Position",
    "TerrainBlockLoaded",
    "TerrainCheckClient",
    "TerrainCheckServer",
    "TerrainClient",
    "TerrainMap",
    "TerrainServer",
    "TerrainState",
    "WaitForTerrain",
    "locate",
    "moved",
]
