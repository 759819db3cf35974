"""Actions at a place of the map in Chromium: look there, make it home, measure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from mavstack.sim import BackgroundSimulator
from tests.interop.station import DESKTOP, PATIENT, near, station_page, web_server
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from pathlib import Path

    from tests.interop.station import StationPage, StationServer

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

#: The colour of the first vehicle on the map.
VEHICLE = (86, 180, 233)


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
@pytest.mark.flight_cases(1)
def test_a_vehicle_looks_at_a_place_and_takes_it_as_home(firmware: str, browser: Any, tmp_path: Path) -> None:
    simulator = BackgroundSimulator(firmware=firmware)
    make_ready(simulator.simulation)
    payload = simulator.vehicle.autopilot.payload
    with (
        simulator,
        web_server(tmp_path, f"udpout://127.0.0.1:{simulator.port}") as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        shown.wait_for("Ready to arm")
        shown.wait_until(lambda: server.state()["home"] is not None)
        before = server.state()["home"]
        shown.page.mouse.click(720, 330)
        shown.button("Look here").click(timeout=PATIENT)
        shown.wait_until(lambda: payload.region_of_interest is not None)
        shown.page.mouse.click(720, 330)
        shown.button("Look ahead").click(timeout=PATIENT)
        shown.wait_until(lambda: payload.region_of_interest is None)
        shown.page.mouse.click(720, 330)
        shown.hold("Set home here")
        shown.wait_until(lambda: server.state()["home"]["latitude"] > before["latitude"] + 1e-6)
        assert server.state()["home"]["altitude"] == pytest.approx(before["altitude"], abs=0.1)


def measure_to_the_east(shown: StationPage, server: StationServer) -> Any:
    """Measure a distance on the map of the demo; return the text of it."""
    shown.page.goto(f"{server.url}?demo=1")
    shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
    shown.wait_until(lambda: near(shown.drawn(), VEHICLE, 30) > 40)
    shown.page.mouse.click(620, 400)
    shown.button("Measure").click(timeout=PATIENT)
    shown.page.mouse.click(820, 400)
    measured = shown.page.get_by_text("° from the start")
    measured.wait_for(timeout=PATIENT)
    return measured


def test_distances_are_measured(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page, measured = shown.page, measure_to_the_east(shown, server)
        assert "090°" in measured.inner_text()
        page.keyboard.press("Escape")
        page.mouse.click(620, 600)
        measured.wait_for(timeout=PATIENT)
        assert "180°" in measured.inner_text()
        shown.button("End measuring").press("Enter")
        page.get_by_role("dialog", name="Target").wait_for(state="detached", timeout=PATIENT)
        page.mouse.click(620, 400)
        shown.button("Measure").wait_for(timeout=PATIENT)
        assert measured.count() == 0


@pytest.mark.nightly
def test_measuring_ends_with_the_link(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page, measured = shown.page, measure_to_the_east(shown, server)
        page.get_by_role("button", name="Sources of the station:").click()
        shown.button("Back to the station").click()
        measured.wait_for(state="detached", timeout=PATIENT)
