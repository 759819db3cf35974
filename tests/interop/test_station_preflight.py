"""The check list before each flight in Chromium: items of the vehicle, ticks by hand, own items."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from tests.interop.station import DESKTOP, PATIENT, station_page, station_server

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]


def test_the_check_list_of_a_copter(browser: Any, tmp_path: Path) -> None:
    with station_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        page.get_by_role("button", name="Check list").click(timeout=PATIENT)
        shown.wait_for("The vehicle is ready to arm")
        page.get_by_label("Own item").fill("Camera cleaned")
        shown.button("Add an item").click()
        boxes = page.locator(".list input[type=checkbox]")
        shown.wait_until(lambda: boxes.count() == 7)
        for index in range(7):
            boxes.nth(index).check()
        shown.wait_until(lambda: page.locator(".list .bad").count() == 0)
        page.get_by_role("button", name="Check list Ready").wait_for(timeout=PATIENT)
        server.post("vehicles/1/arm")
        shown.wait_for("Armed")
        server.post("vehicles/1/disarm")
        shown.wait_until(lambda: page.locator(".list input:checked").count() == 0)
        shown.button("Remove Camera cleaned").click()
        shown.wait_until(lambda: boxes.count() == 6)
