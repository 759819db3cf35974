"""The reports of a vehicle in tests of checks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.services.terrain import TerrainMap


def report_of(terrain: TerrainMap):
    """Return the reporter of a vehicle that has this map."""

    def report(latitude: float, longitude: float) -> common.TerrainReport:
        height = terrain.height(latitude, longitude)
        spacing = 0 if height is None else terrain.spacing
        loaded, pending = terrain.loaded, terrain.pending
        return common.TerrainReport(
            spacing=spacing, terrain_height=height or 0.0, current_height=5.0, loaded=loaded, pending=pending
        )

    return report
