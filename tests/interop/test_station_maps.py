"""Base maps of the station in Chromium: tiles and archives of another server."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from tests.interop.station import DESKTOP, PATIENT, near, station_page, web_server
from tests.interop.tiles import VECTORS, archive, area, picture, tile_server

if TYPE_CHECKING:
    from pathlib import Path

    from tests.interop.station import StationPage

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

#: The colours of the tiles and of the archive, and pixels of the map that must have them.
TILES, ARCHIVE, ENOUGH = (200, 40, 40), (40, 160, 60), 100_000
#: The colour of water on the light map.
WATER = (188, 216, 238)
FILES = {
    ".png": picture(TILES),
    "earth.pmtiles": archive(picture(ARCHIVE)),
    "water.pmtiles": archive(area("water"), VECTORS, ("water",)),
}


def choose_tiles(shown: StationPage, address: str) -> None:
    """Enter the address of tiles in the settings."""
    shown.page.keyboard.press(",")
    shown.page.get_by_label("Map tiles").fill(address)
    shown.page.keyboard.press("Tab")
    shown.page.keyboard.press("Escape")
    shown.page.get_by_label("Map tiles").wait_for(state="hidden", timeout=PATIENT)


def test_tiles_and_archives_are_the_base_map(browser: Any, tmp_path: Path) -> None:
    with (
        tile_server(FILES) as tiles,
        web_server(tmp_path) as server,
        station_page(browser, server.url, DESKTOP, "light") as shown,
    ):
        shown.page.goto(f"{server.url}?demo=1")
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        seen = shown.page.locator(".map")
        bases = (("{z}/{x}/{y}.png", TILES), ("earth.pmtiles", ARCHIVE), ("water.pmtiles", WATER))
        for path, colour in bases:
            assert near(shown.pixels(seen), colour, 12) < ENOUGH
            choose_tiles(shown, f"{tiles}/{path}")
            shown.wait_until(lambda colour=colour: near(shown.pixels(seen), colour, 12) > ENOUGH)
        problem = shown.page.get_by_text("The map tiles cannot be read")
        assert problem.count() == 0
        choose_tiles(shown, f"{tiles}/closed/{{z}}/{{x}}/{{y}}.png")
        problem.wait_for(timeout=PATIENT)
        shown.expect_problems(tiles, "Access to", "Failed to load resource")
