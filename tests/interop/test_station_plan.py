"""Plan and set-up in Chromium: a plan is drawn, sent and read again; a parameter and a sensor are set up."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.files.plans import PlanFile, format_plan, parse_plan, plan_json
from tests.interop.station import (
    DESKTOP,
    PATIENT,
    PHONE,
    StationPage,
    StationServer,
    near,
    station_page,
    station_server,
)

if TYPE_CHECKING:
    import numpy as np

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]

#: The colours of the dark map.
MISSION, FENCE, VEHICLE = (240, 201, 60), (32, 180, 140), (86, 180, 233)
#: Half of the width of a vehicle on the map.
MARK = 30
#: Digits that vehicles keep: latitude and longitude as multiples of 1e-7, others as floats of 32 bits.
DIGITS = (4, 4, 4, 4, 7, 7, 4)
KINDS = ("mission", "fence", "rally")


def held_plan(server: StationServer) -> dict[str, list[Any]]:
    """Return the plans that the vehicle holds."""
    return {kind: rounded(server.get(f"vehicles/1/{kind}")[kind]) for kind in KINDS}


def saved_text(shown: StationPage, format_name: str) -> str:
    """Return the file that the page saves."""
    with shown.page.expect_download() as waiting:
        shown.page.get_by_label("Save as").select_option(format_name)
    return Path(waiting.value.path()).read_text("utf-8")


def saved_plan(shown: StationPage) -> dict[str, list[Any]]:
    """Return the plans that the page saves as a file."""
    plan = json.loads(saved_text(shown, "json"))
    return {kind: rounded(plan[kind]) for kind in KINDS}


def items_of(plan: PlanFile, kind: str) -> list[Any]:
    """Return the items of a plan that Python has read, as `saved_plan` does."""
    return rounded(plan_json(plan)[kind])


def opened(shown: StationPage, name: str, text: str) -> None:
    """Open a file in the page."""
    file = {"name": name, "mimeType": "text/plain", "buffer": text.encode()}
    shown.page.locator("input[type=file]").first.set_input_files(file)


def rounded(items: list[dict[str, Any]]) -> list[Any]:
    """Return the items as vehicles hold them: degrees as multiples of 1e-7."""
    return [(item["command"], item["frame"], rounded_params(item["params"])) for item in items]


def rounded_params(params: list[float | None]) -> list[float | None]:
    return [
        None if each is None else round(each, digits) for each, digits in zip(params, DIGITS, strict=True)
    ]


def draw(shown: StationPage, key: str, *places: tuple[int, int]) -> None:
    """Take a tool by its key and click on places, in pixels from the middle of the map."""
    box = shown.page.locator(".map .host").bounding_box()
    shown.page.keyboard.press(key)
    for right, down in places:
        shown.page.mouse.click(box["x"] + box["width"] / 2 + right, box["y"] + box["height"] / 2 + down)


def show_plan(shown: StationPage, url: str) -> None:
    """Show an empty plan, with the vehicle in the middle of the map."""
    shown.page.goto(f"{url}#/plan")
    shown.page.get_by_label("Map of the plan").first.wait_for()
    shown.wait_until(lambda: near(middle(shown.drawn()), VEHICLE) > 40)


def middle(picture: np.ndarray) -> np.ndarray:
    """Return the part of a picture that a vehicle in its middle covers."""
    down, right = picture.shape[0] // 2, picture.shape[1] // 2
    return picture[down - MARK : down + MARK, right - MARK : right + MARK]


def test_a_plan_is_drawn_uploaded_and_downloaded(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, DESKTOP) as shown:
        show_plan(shown, server.url)
        draw(shown, "w", (0, -150), (150, -90), (120, 90))
        shown.page.keyboard.press("Escape")
        draw(shown, "o", (40, 0))
        # The shape that was drawn last can be edited.
        shown.page.get_by_label("Radius", exact=True).wait_for(timeout=PATIENT)
        draw(shown, "r", (-60, 60))
        draw(shown, "s", (-90, -60), (90, -60), (90, 60), (-90, 60))
        shown.button("Insert into the mission").click()
        picture = shown.drawn()
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
        # The plan differs from the one on the vehicle now, and the buttons keep their names and places.
        shown.page.get_by_title("The plan differs").wait_for(timeout=PATIENT)
        assert shown.button("Upload").bounding_box()["y"] == shown.button("Open a file").bounding_box()["y"]


def draw_all(shown: StationPage, url: str) -> None:
    """Draw waypoints, a circle to stay in, a polygon to stay in and a rally point."""
    show_plan(shown, url)
    draw(shown, "w", (0, -150), (150, -90), (120, 90))
    draw(shown, "o", (40, 0))
    draw(shown, "p", (-250, -200), (250, -200), (250, 200), (-250, 200))
    shown.button("Finish").click()
    draw(shown, "r", (-60, 60))
    shown.page.keyboard.press("Escape")


def test_files_of_the_page_and_of_python_are_the_same(
    seen_server: StationServer, browser: Any, tmp_path: Path
) -> None:
    mavwp = pytest.importorskip("pymavlink.mavwp")
    with station_page(browser, seen_server.url, DESKTOP) as shown:
        draw_all(shown, seen_server.url)
        drawn = saved_plan(shown)
        for name in ("plan", "json"):
            read = parse_plan(saved_text(shown, name))
            assert {kind: items_of(read, kind) for kind in KINDS} == drawn
        waypoints = saved_text(shown, "waypoints")
        assert items_of(parse_plan(waypoints), "mission") == drawn["mission"]
        (tmp_path / "drawn.waypoints").write_text(waypoints, "utf-8")
        loader = mavwp.MAVWPLoader()
        # The home is its item 0.
        assert loader.load(str(tmp_path / "drawn.waypoints")) == len(drawn["mission"]) + 1
        assert [loader.wp(index).command for index in range(1, loader.count())] == [
            command for command, _, _ in drawn["mission"]
        ]
        whole = parse_plan(saved_text(shown, "json"))
        for name in ("plan", "json", "waypoints"):
            opened(shown, f"by-python-{name}.txt", format_plan(whole, name).text)
            shown.wait_for(f"by-python-{name}.txt opened")
            found = saved_plan(shown)
            assert found["mission"] == drawn["mission"]
            assert name == "waypoints" or found == drawn


def test_work_is_not_lost(seen_server: StationServer, browser: Any) -> None:
    with station_page(browser, seen_server.url, DESKTOP) as shown:
        draw_all(shown, seen_server.url)
        draw(shown, "s", (-90, -60), (90, -60), (90, 60))
        shown.wait_for("lanes,")
        # The last corner is taken back, not the last edit.
        shown.page.keyboard.press("Control+z")
        shown.page.get_by_text("lanes,").wait_for(state="detached")
        shown.page.keyboard.press("Escape")
        for name in ("Download", "New plan"):
            shown.button(name).click()
            shown.wait_for("neither in a file nor on the vehicle")
            shown.button("Cancel").click()
        opened(shown, "other.waypoints", "QGC WPL 110\n")
        shown.wait_for("neither in a file nor on the vehicle")
        shown.button("Cancel").click()
        shown.page.reload()
        shown.page.locator("#plan-item-3").wait_for()
        drawn = saved_plan(shown)
        assert [len(drawn[kind]) for kind in KINDS] == [4, 5, 1]
        # The file has the plan now: nothing is asked.
        shown.button("New plan").click()
        shown.wait_for("The mission is empty")
        shown.page.keyboard.press("Control+z")
        shown.page.locator("#plan-item-3").wait_for()


def test_wrong_files_are_reported_in_one_line(seen_server: StationServer, browser: Any) -> None:
    with station_page(browser, seen_server.url, DESKTOP) as shown:
        shown.page.goto(f"{seen_server.url}#/plan")
        for name, text, reason in (
            ("map.kmz", "PK\x03\x04…", "the file is an archive"),
            ("notes.txt", "latitude;longitude", "the file is no plan"),
            ("short.waypoints", "QGC WPL 110\n\n0 1", "line 3: has 2 columns instead of 12"),
            ("half.plan", '{"mission": {"items": [{}]}}', "mission.items[0]: has no"),
        ):
            opened(shown, name, text)
            shown.wait_for(reason)


@pytest.mark.nightly
def test_the_current_item_is_marked(browser: Any, tmp_path: Path) -> None:
    with station_server(tmp_path) as flown, station_page(browser, flown.url, DESKTOP) as shown:
        draw_all(shown, flown.url)
        shown.button("Upload").click()
        shown.wait_for("Rally: on the vehicle (1)")
        flown.post("vehicles/1/mission/current", seq=2)
        # ArduPilot counts its home as item 0: its 2 is the second item of the plan.
        shown.page.get_by_role("tab", name="Mission").click()
        shown.page.locator("#plan-item-1 .current").wait_for()
        shown.page.locator("#plan-item-3").click()
        shown.page.keyboard.press("Delete")
        # The plan is not the one of the vehicle any more.
        shown.page.locator("#plan-item-1 .current").wait_for(state="detached")


def test_a_parameter_and_a_sensor_are_set_up(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, DESKTOP) as shown:
        shown.page.goto(f"{server.url}#/setup")
        shown.page.get_by_label("Search names and descriptions").fill("height returns")
        field = shown.page.get_by_label("RTL_ALT", exact=True)
        field.wait_for(timeout=60_000)
        shown.wait_for("Height above home at which the vehicle returns")  # its range comes with it
        field.fill("1")
        field.press("Enter")
        shown.wait_for("The smallest value is 30.")
        field.fill("2500")
        field.press("Enter")
        shown.wait_for("before 1500")
        assert server.get("vehicles/1/parameters/RTL_ALT")["value"] == 2500
        shown.button("Set RTL_ALT to its default 1500").click()
        shown.wait_until(lambda: field.input_value() == "1500")
        shown.button("Calibration").click()
        shown.button("Start: Gyroscope").click()
        shown.wait_for("The calibration is done.")


def test_plan_and_set_up_fit_a_phone(seen_server: StationServer, browser: Any) -> None:
    with station_page(browser, seen_server.url, PHONE, "light") as shown:
        shown.page.goto(f"{seen_server.url}#/plan")
        tools = shown.page.get_by_role("toolbar").get_by_role("button")
        tools.first.wait_for(timeout=PATIENT)
        boxes = [tools.nth(index).bounding_box() for index in range(tools.count())]
        # All are on the screen, and as large as a finger.
        assert len(boxes) == 11
        assert all(box["x"] >= 0 and box["x"] + box["width"] <= PHONE[0] for box in boxes)
        assert all(min(box["width"], box["height"]) >= 40 for box in boxes)
        for tab in ("Fence", "Rally", "Checks", "Mission"):
            shown.page.get_by_role("tab", name=tab).click()
            assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
        shown.page.goto(f"{seen_server.url}#/setup")
        for section in ("Flight modes", "Failsafes", "Motors and outputs", "Estimator", "Calibration"):
            shown.button(section).click()
            assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
