"""Plans in Chromium: a corridor with terrain and fence, a mission sent with progress and saved as KML."""

from __future__ import annotations

import json
import math
import re
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.interop.station import (
    DESKTOP,
    PATIENT,
    StationPage,
    StationServer,
    near,
    station_page,
    web_server,
)
from tests.interop.test_station_plan import (
    MISSION,
    VEHICLE,
    draw,
    opened,
    saved_plan,
    saved_text,
    show_plan,
)
from tests.interop.tiles import picture, tile_server

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from mavstack.sim import BackgroundSimulator

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]

CORRIDOR = ((-150, -120), (0, -40), (150, -120))
TRIGGER_DISTANCE = 206  # MAV_CMD_DO_SET_CAM_TRIGG_DIST
METRES_IN_DEGREE = 111_200
KML = "{http://www.opengis.net/kml/2.2}"
#: Keeps each text and value of a bar of progress that the page shows.
WATCH_PROGRESS = """
window.progress = [];
new MutationObserver(() => {
  for (const bar of document.querySelectorAll('[role=progressbar], progress')) {
    const value = bar.getAttribute('aria-valuenow') ?? bar.getAttribute('value');
    window.progress.push([bar.getAttribute('aria-label'), value === null ? null : Number(value)]);
  }
}).observe(document.body, { attributes: true, childList: true, subtree: true });
"""


def draw_corridor(shown: StationPage) -> None:
    draw(shown, "c", *CORRIDOR)
    shown.page.get_by_text("lanes,").wait_for(timeout=PATIENT)
    shown.button("Insert into the mission").click()


def show_checks(shown: StationPage) -> None:
    shown.page.get_by_role("tab", name="Checks").click()


def slope(home: dict[str, float], gradient: float) -> dict[str, Any]:
    """Return an .hgt file of terrain that rises to the north and has the height of a place there."""
    latitude, longitude = math.floor(home["latitude"]), math.floor(home["longitude"])
    name = f"{'NS'[latitude < 0]}{abs(latitude):02}{'EW'[longitude < 0]}{abs(longitude):03}.hgt"
    north = (np.linspace(latitude + 1, latitude, 1201) - home["latitude"]) * METRES_IN_DEGREE
    rows = np.clip(home["altitude"] + gradient * north, -500, 9000).round().astype(">i2")
    data = np.repeat(rows, 1201).tobytes()
    return {"name": name, "mimeType": "application/octet-stream", "buffer": data}


@pytest.mark.nightly
def test_a_corridor_is_checked_with_terrain_and_fence(seen_server: StationServer, browser: Any) -> None:
    with station_page(browser, seen_server.url, DESKTOP) as shown:
        show_plan(shown, seen_server.url)
        draw_corridor(shown)
        assert near(shown.drawn(), MISSION) > 300
        drawn = saved_plan(shown)["mission"]
        assert TRIGGER_DISTANCE in [command for command, _, _ in drawn]
        show_checks(shown)
        shown.wait_for("The clearance is not known")
        home = json.loads(saved_text(shown, "json"))["home"]
        shown.page.locator("input[accept='.hgt']").set_input_files(slope(home, 0.25))
        shown.page.get_by_text(re.compile(r"comes within 1\d m of the ground; the limit is 20 m")).wait_for()
        shown.page.locator("input[accept='.hgt']").set_input_files(slope(home, 1))
        shown.page.get_by_text(re.compile(r"-\d+ m above the ground: below the terrain")).wait_for()
        assert shown.page.get_by_role("img", name="Altitude above the terrain").is_visible()
        # A polygon to stay out of, over the corridor.
        draw(shown, "p", (-60, -140), (60, -140), (60, 0), (-60, 0))
        shown.button("Finish").click()
        shown.page.get_by_role("tab", name="Fence").click()
        shown.page.get_by_role("combobox", name="Polygon 1").select_option(label="stay out")
        show_checks(shown)
        shown.page.get_by_text(re.compile("outside of the fence|leaves the fence")).first.wait_for()


def terrarium(height: float) -> tuple[int, int, int]:
    """Return the colour of a height in metres."""
    steps = round((height + 32_768) * 256)
    return steps >> 16, steps >> 8 & 0xFF, steps & 0xFF


def test_terrain_of_tiles_is_checked(seen_server: StationServer, browser: Any) -> None:
    ground = seen_server.state()["home"]["altitude"] + 12
    tiles = {"terrain.png": picture(terrarium(ground))}
    with tile_server(tiles) as address, station_page(browser, seen_server.url, DESKTOP) as shown:
        shown.expect_problems(address)
        show_plan(shown, seen_server.url)
        draw_corridor(shown)
        show_checks(shown)
        shown.page.get_by_label("Address of terrain tiles").fill(f"{address}/{{z}}/{{x}}/{{y}}/terrain.png")
        shown.page.keyboard.press("Tab")
        shown.wait_for("Lowest clearance: 30 m")
        # The ground below home, and the path above it.
        for height in (ground, ground + 30):
            shown.page.locator("figcaption").get_by_text(f"{height:.0f} m", exact=True).wait_for()


def test_the_map_stays_where_something_is_drawn(
    simulator: BackgroundSimulator, browser: Any, tmp_path: Path
) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        shown.page.goto(f"{server.url}#/plan")
        shown.page.get_by_label("Map of the plan").first.wait_for()
        draw(shown, "p", (-300, 200), (300, 200))
        shown.wait_until(lambda: shown.drawn().shape[0] > 400)
        before = shown.drawn()
        server.post("sources", url=f"udpout://127.0.0.1:{simulator.port}")
        shown.wait_until(lambda: near(shown.drawn(), VEHICLE) > near(before, VEHICLE) + 40)
        down = before.shape[0] // 2 + 200
        assert near(before[down - 10 : down + 10], VEHICLE) > 500
        assert (shown.drawn()[down - 10 : down + 10] == before[down - 10 : down + 10]).all()
        shown.button("Undo").click()
        shown.wait_until(lambda: near(shown.drawn()[down - 10 : down + 10], VEHICLE) < 300)


@pytest.fixture
def slow_server(simulator: BackgroundSimulator, tmp_path: Path) -> Iterator[StationServer]:
    """Serve a station whose vehicle answers late, so that a page sees transfers go on."""
    with web_server(tmp_path, f"udpout://127.0.0.1:{simulator.port}?latency=20ms") as running:
        yield running


def test_a_long_mission_is_sent_with_progress_and_saved_as_kml(
    slow_server: StationServer, browser: Any
) -> None:
    with station_page(browser, slow_server.url, DESKTOP) as shown:
        show_plan(shown, slow_server.url)
        draw(shown, "s", (-250, -200), (250, -200), (250, 200), (-250, 200))
        shown.button("Insert into the mission").click()
        draw(shown, "p", (-300, -250), (300, -250), (300, 250), (-300, 250))
        shown.button("Finish").click()
        drawn = saved_plan(shown)
        assert len(drawn["mission"]) > 20
        tree = ElementTree.fromstring(saved_text(shown, "kml"))
        assert len(tree.findall(f".//{KML}Polygon")) == 1
        written = saved_text(shown, "kml")
        shown.page.evaluate(WATCH_PROGRESS)
        shown.button("Upload").click()
        shown.wait_for("Fence: on the vehicle (4)")
        shown.button("New plan").click()
        shown.page.get_by_role("tab", name="Mission").click()
        shown.wait_for("The mission is empty")
        shown.button("Download").click()
        shown.wait_for("Fence: downloaded (4)")
        assert saved_plan(shown) == drawn
        shown_steps = shown.page.evaluate("window.progress")
        for label in ("Uploading Mission", "Downloading Mission"):
            values = [value for name, value in shown_steps if name == label and value is not None]
            assert len(set(values)) > 3, shown_steps[:50]
            assert values == sorted(values)
        opened(shown, "drawn.kml", written)
        shown.wait_for("drawn.kml opened")
        again = saved_plan(shown)
        assert len(again["fence"]) == 4
        places = [params[4:6] for command, _, params in drawn["mission"] if command == 16]
        found = [params[4:6] for command, _, params in again["mission"] if command == 16]
        # The path of the file begins with the climb above home.
        assert found[2 : len(places) + 2] == places
