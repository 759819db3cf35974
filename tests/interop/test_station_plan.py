"""Plan and set-up in Chromium: a plan is drawn, sent and read again; a parameter and a sensor are set up."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.request import urlopen

import pytest

from tests.interop.station import (
    DESKTOP,
    PHONE,
    StationPage,
    StationServer,
    chromium,
    near,
    station_page,
    station_server,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]

#: The colours of the dark map.
MISSION, FENCE, VEHICLE = (240, 201, 60), (32, 180, 140), (86, 180, 233)
KINDS = ("mission", "fence", "rally")


@pytest.fixture(scope="module")
def server(tmp_path_factory: Any) -> Iterator[StationServer]:
    with station_server(tmp_path_factory.mktemp("recordings")) as running:
        yield running


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as opened:
        yield opened


def held_plan(server: StationServer) -> dict[str, list[Any]]:
    """Return the plans that the vehicle holds."""
    held = {}
    for kind in KINDS:
        with urlopen(f"{server.url}api/vehicles/1/{kind}", timeout=20) as answer:
            held[kind] = rounded(json.load(answer)[kind])
    return held


def saved_plan(shown: StationPage) -> dict[str, list[Any]]:
    """Return the plans that the page saves as a file."""
    with shown.page.expect_download() as waiting:
        shown.page.get_by_label("Save as").select_option("json")
    plan = json.loads(Path(waiting.value.path()).read_text("utf-8"))
    return {kind: rounded(plan[kind]) for kind in KINDS}


def rounded(items: list[dict[str, Any]]) -> list[Any]:
    """Return the items as vehicles hold them: degrees as multiples of 1e-7."""
    return [
        (
            item["command"],
            item["frame"],
            [None if each is None else round(each, 6) for each in item["params"]],
        )
        for item in items
    ]


def draw(shown: StationPage, key: str, *places: tuple[int, int]) -> None:
    """Take a tool by its key and click on places, in pixels from the middle of the map."""
    box = shown.page.locator(".map .host").bounding_box()
    shown.page.keyboard.press(key)
    for right, down in places:
        shown.page.mouse.click(box["x"] + box["width"] / 2 + right, box["y"] + box["height"] / 2 + down)


def map_picture(shown: StationPage) -> Any:
    return shown.pixels(shown.page.locator(".map").first)


def test_a_plan_is_drawn_uploaded_and_downloaded(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, DESKTOP) as shown:
        shown.page.goto(f"{server.url}#/plan")
        shown.wait_for("Copter 1")
        shown.page.get_by_label("Map of the plan").first.wait_for()
        shown.wait_until(lambda: near(map_picture(shown), VEHICLE) > 40)
        draw(shown, "w", (0, -150), (150, -90), (120, 90))
        shown.page.keyboard.press("Escape")
        draw(shown, "o", (40, 0))
        draw(shown, "r", (-60, 60))
        draw(shown, "s", (-90, -60), (90, -60), (90, 60), (-90, 60))
        shown.button("Insert into the mission").click()
        picture = map_picture(shown)
        assert near(picture, MISSION) > 500
        assert near(picture, FENCE) > 300
        drawn = saved_plan(shown)
        assert [len(drawn[kind]) > 0 for kind in KINDS] == [True, True, True]
        assert len(drawn["mission"]) > 10
        shown.button("Upload").click()
        shown.wait_for("Rally: on the vehicle (1)")
        assert held_plan(server) == drawn
        shown.button("New plan").click()
        shown.wait_for("The mission is empty")
        shown.button("Download").click()
        shown.wait_for("Rally: downloaded (1)")
        assert saved_plan(shown) == drawn
        shown.page.keyboard.press("Control+z")
        shown.wait_for("The mission is empty")


def test_a_parameter_and_a_sensor_are_set_up(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, DESKTOP) as shown:
        shown.page.goto(f"{server.url}#/setup")
        shown.page.get_by_label("Search names and descriptions").fill("height returns")
        field = shown.page.get_by_label("RTL_ALT", exact=True)
        field.wait_for(timeout=60_000)
        field.fill("1")
        field.press("Enter")
        shown.wait_for("The smallest value is 30.")
        field.fill("2500")
        field.press("Enter")
        shown.wait_for("before 1500")
        with urlopen(f"{server.url}api/vehicles/1/parameters/RTL_ALT", timeout=20) as answer:
            assert json.load(answer)["value"] == 2500
        shown.button("Set RTL_ALT to its default 1500").click()
        shown.wait_until(lambda: field.input_value() == "1500")
        shown.button("Calibration").click()
        shown.button("Start: Gyroscope").click()
        shown.wait_for("The calibration is done.")


def test_plan_and_set_up_fit_a_phone(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, PHONE, "light") as shown:
        shown.page.goto(f"{server.url}#/plan")
        for tab in ("Fence", "Rally", "Checks", "Mission"):
            shown.page.get_by_role("tab", name=tab).click()
            assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
        shown.page.goto(f"{server.url}#/setup")
        for section in ("Flight modes", "Failsafes", "Motors and outputs", "Estimator", "Calibration"):
            shown.button(section).click()
            assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
