"""A group of copters in Chromium: in formation to one place, warned of each other; alerts of a fault."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest

from mavstack.sim import BackgroundSimulator
from tests.interop.station import DESKTOP, PATIENT, StationServer, station_page, web_server
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]


def take_off_apart(server: StationServer) -> None:
    """Fly copter 2 to a place 20 m east of copter 1, two metres higher."""
    for system, altitude in ((1, 10.0), (2, 12.0)):
        server.post(f"vehicles/{system}/arm")
        server.post(f"vehicles/{system}/takeoff", altitude=altitude)
    server.post("vehicles/2/move", east=20.0)


def test_a_group_keeps_its_formation_or_is_warned(browser: Any, tmp_path: Path) -> None:
    simulator = BackgroundSimulator(count=2, speed=5)
    make_ready(simulator.simulation)
    with simulator:
        link = f"udpout://127.0.0.1:{simulator.port}"
        with web_server(tmp_path, link) as server, station_page(browser, server.url, DESKTOP) as shown:
            page = shown.page
            shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
            take_off_apart(server)
            sent: dict[str, dict[str, float]] = {}

            def keep(request: Any) -> None:
                path = urlsplit(request.url).path
                if request.method == "POST" and path.endswith("/goto"):
                    sent[path.split("/")[3]] = json.loads(request.post_data)

            page.on("request", keep)
            shown.button("All").click()
            page.mouse.click(720, 300)
            menu = page.get_by_role("dialog", name="Target")
            formation = menu.get_by_label("Keep the formation")
            formation.uncheck(timeout=PATIENT)
            menu.get_by_text("Go here: vehicles 1 and 2 would be too close").wait_for(timeout=PATIENT)
            formation.check()
            menu.get_by_text("Go here: vehicles").wait_for(state="detached", timeout=PATIENT)
            shown.hold("Go here")
            shown.wait_until(lambda: len(sent) == 2)
            first, second = sent["1"], sent["2"]
            assert "altitude" not in first
            assert "altitude" not in second
            assert (second["longitude"] - first["longitude"]) * 75_300 == pytest.approx(20, abs=3)
            assert first["latitude"] == pytest.approx(second["latitude"], abs=2e-5)
            simulator.call(lambda: simulator.simulation.vehicles[1].faults.inject("battery 10"))
            alert = page.get_by_role("button", name="Copter 2: Battery critical, land now")
            alert.click(timeout=PATIENT)
            shown.button("Choose a vehicle: Copter 2").wait_for(timeout=PATIENT)
