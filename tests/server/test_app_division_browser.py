"""Plan view: a survey that the station's planner divides among two vehicles."""

from __future__ import annotations

import json
import re
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any
from urllib.request import urlopen

import pytest

from mavstack.sim.background import BackgroundSimulator
from tests.server.browsing import hold, open_pages, web_station
from tests.sharing import shared_until_failure
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")


@shared_until_failure
def world(folder: Path) -> Any:
    """Two copters: the URL of their station, and a function for pages."""
    simulator = BackgroundSimulator(count=2)
    make_ready(simulator.simulation)
    with ExitStack() as steps:
        steps.enter_context(simulator)
        url = steps.enter_context(web_station(folder, simulator.url))
        yield url, steps.enter_context(open_pages())


def mission(url: str, system: int) -> list[dict[str, Any]]:
    with urlopen(f"{url}api/vehicles/{system}/mission", timeout=30) as answer:
        items: list[dict[str, Any]] = json.load(answer)["mission"]
        return items


def places(items: list[dict[str, Any]]) -> set[tuple[float, float]]:
    return {tuple(each["params"][4:6]) for each in items if each["name"] == "NAV_WAYPOINT"}


@pytest.mark.parametrize("phone", [False, True], ids=["desktop", "phone"])
@pytest.mark.flight_cases(1)
def test_a_survey_is_divided_shown_and_uploaded(world: Any, phone: bool) -> None:
    url, new_page = world
    page = new_page(f"{url}#/plan", phone=phone, dark=not phone)
    playwright.expect(page.get_by_role("button", name="Choose a vehicle")).to_contain_text("Copter")
    page.wait_for_timeout(1000)
    page.get_by_role("button", name=re.compile("^Survey")).first.click()
    shown = page.locator(".map > canvas").first.bounding_box()
    middle = shown["x"] + shown["width"] / 2
    for right, part in ((-60, 0.42), (60, 0.42), (60, 0.75), (-60, 0.75)):
        page.mouse.click(middle + right, shown["y"] + part * shown["height"])
        page.wait_for_timeout(400)
    group = page.get_by_role("group", name="Divide among vehicles")
    for name in ("Copter 1", "Copter 2"):
        group.get_by_role("checkbox", name=name).check()
    group.get_by_role("button", name="Divide among 2 vehicles").click()
    parts = group.get_by_role("listitem")
    playwright.expect(parts).to_have_count(2)
    playwright.expect(parts.first).to_have_text(re.compile(r"Copter 1: \d+ lanes?, \d+ m, at 30"))
    hold(page, group.get_by_role("button", name="Upload each part"))
    playwright.expect(page.get_by_text("Each vehicle has its part.")).to_be_visible()
    first, second = (places(mission(url, system)) for system in (1, 2))
    assert first
    assert second
    assert not first & second
    group.get_by_role("checkbox", name="Copter 2").uncheck()
    playwright.expect(parts).to_have_count(0)
