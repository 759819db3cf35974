"""The fly view in Chromium: a copter is refused, armed, flown, steered by sticks and landed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from tests.interop.station import (
    DESKTOP,
    MANUAL_CONTROL,
    PATIENT,
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

SKY, GROUND, VEHICLE = (79, 148, 216), (138, 95, 53), (86, 180, 233)


@pytest.fixture(scope="module")
def server(tmp_path_factory: Any) -> Iterator[StationServer]:
    with station_server(tmp_path_factory.mktemp("recordings")) as running:
        yield running


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as opened:
        yield opened


def set_mode(shown: StationPage, name: str) -> None:
    shown.page.get_by_label("Flight mode").select_option(name)
    shown.button("Set").click()


def assert_drawn(shown: StationPage) -> None:
    """Assert that horizon and map have the pixels of their parts."""
    horizon = shown.pixels(shown.page.get_by_role("img", name="Flight display"))
    assert near(horizon, SKY) > 500
    assert near(horizon, GROUND) > 500
    assert near(shown.pixels(shown.page.locator(".map")), VEHICLE, 30) > 40


def assert_steered(shown: StationPage) -> None:
    """Assert that sticks are sent while the space bar is held, and no longer."""
    shown.button("Sticks").click()
    shown.page.get_by_label("Steer with", exact=True).select_option("keys")
    shown.page.get_by_role("switch").check()
    shown.wait_for("Ready: hold the space bar")
    shown.page.evaluate("document.activeElement.blur()")  # keys in forms do not steer
    shown.sent.clear()
    shown.page.keyboard.down(" ")
    shown.page.keyboard.down("ArrowUp")
    shown.wait_for("Steering vehicle 1")
    shown.page.wait_for_timeout(1500)
    assert shown.sent.count(MANUAL_CONTROL) > 20  # 75 where nothing else runs
    shown.page.evaluate("window.dispatchEvent(new Event('blur'))")
    shown.wait_for("Ready: hold the space bar")
    stopped = shown.sent.count(MANUAL_CONTROL)
    shown.page.wait_for_timeout(300)
    assert shown.sent.count(MANUAL_CONTROL) == stopped
    shown.page.keyboard.up("ArrowUp")
    shown.page.keyboard.up(" ")
    shown.page.get_by_role("switch").uncheck()


def test_a_copter_is_flown(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, DESKTOP) as shown:
        shown.wait_for("Ready to arm")
        set_mode(shown, "RTL")
        shown.wait_until(lambda: server.state()["mode"] == "RTL")
        shown.hold("Arm")
        shown.page.get_by_role("alert").get_by_text("mode not armable").first.wait_for(timeout=PATIENT)
        set_mode(shown, "GUIDED")
        shown.wait_until(lambda: server.state()["mode"] == "GUIDED")
        shown.hold("Arm")
        shown.wait_until(lambda: server.state()["armed"])
        shown.hold("Take off")
        shown.wait_until(lambda: server.state()["position"]["relative_altitude"] > 9)
        assert_drawn(shown)
        start = server.state()["position"]["latitude"]
        shown.page.mouse.click(720, 330)
        shown.hold("Go here")
        shown.wait_until(lambda: server.state()["position"]["latitude"] > start + 5e-5)
        assert_steered(shown)
        shown.hold("Land")
        shown.wait_until(lambda: not server.state()["armed"])


def test_the_view_fits_a_phone(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, PHONE, "light") as shown:
        shown.button("Arm").wait_for(timeout=PATIENT)
        assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
        for tab in ("Status", "Messages", "Sticks", "Video"):
            shown.page.get_by_role("tab", name=tab).click()
        assert_drawn(shown)
