"""Base maps of the station in Chromium: tiles and archives of another server."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from tests.interop.station import DESKTOP, PATIENT, PHONE, near, station_page, station_server, web_server
from tests.interop.tiles import VECTORS, archive, area, picture, tile_server
from tests.maps.tile_pages import tile_pages

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


def download_map(shown: StationPage, template: str, name: str, content: str) -> None:
    """Download the area that the map shows, in the dialog, which is open."""
    page = shown.page
    page.get_by_label("Address of the tiles").fill(template)
    page.get_by_label("Name", exact=True).fill(name)
    page.get_by_label("Content").select_option(content)
    page.get_by_label("From zoom level").fill("13")
    page.get_by_label("To zoom level").fill("15")
    shown.button("Estimate").click()
    shown.wait_for("Terms: the server is on this machine")
    shown.button("Download").click()
    shown.wait_for("were there, 0 are not on the server")


def test_a_map_is_downloaded_on_the_page_and_shown_without_network(
    browser: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    tile = (200, picture(TILES), {"Content-Type": "image/png"})
    ground = (200, picture((129, 244, 0)), {"Content-Type": "image/png"})  # 500 m in Terrarium
    with (
        tile_pages(lambda *_: tile) as pages,
        station_server(tmp_path) as server,
        station_page(browser, server.url, DESKTOP, "light") as shown,
    ):
        shown.button("Maps without network").click(timeout=PATIENT)
        download_map(shown, pages.template, "field", "")
        pages.answer = lambda *_: ground
        download_map(shown, pages.template, "heights", "terrarium")
        used = len(pages.requested)
        assert [each["name"] for each in server.get("maps")] == ["field", "heights"]
        shown.button("Show").click()
        shown.page.keyboard.press("Escape")
        seen = shown.page.locator(".map")
        shown.wait_until(lambda: near(shown.pixels(seen), TILES, 12) > ENOUGH)
        assert len(pages.requested) == used, "the page shows the tiles of the station"
        shown.page.evaluate("location.hash = '#/plan'")
        shown.page.get_by_role("tab", name="Checks").click(timeout=PATIENT)
        shown.wait_for("Heights: map heights of the station")
        shown.page.evaluate("location.hash = '#/fly'")
        shown.page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
        shown.button("Maps without network").click(timeout=PATIENT)
        shown.button("Hide").click()
        shown.hold("Remove field")
        shown.wait_until(lambda: [each["name"] for each in server.get("maps")] == ["heights"])
