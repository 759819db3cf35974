"""The controls of the views are used one after the other, with a console free of errors."""

from __future__ import annotations

import re
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.rangefinders import Rangefinder
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.interop.control_crawler import Crawler
from tests.server.browsing import open_pages, web_station
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [
    pytest.mark.interop,
    pytest.mark.nightly,
    pytest.mark.xdist_group("chromium"),
    pytest.mark.timeout(600),
]

VIEWS = ("fly", "setup")
#: Parameters that keep a vehicle on the ground armed.
STAY_ARMED = {"DISARM_DELAY": 0}
#: Controls that need a flight, a gamepad, a camera, a file or a confirmation, and the tests that use them.
NOT_USED = {
    r"(Altitude: Set|Altitude m|Speed: Set|Speed m|Disarm|Land|Return|Hold|Take off)": "test_station_fly.py",
    r"button: (Dismiss|Close|Remove|Clear|End|Play|Record)\b": "test_station_video.py, test_station_maps.py",
    r"button: (Download|None|Beep)$": "test_station_maps.py, test_app_payload_browser.py",
    r"summary: Settings of the controller|select: Steer with": "test_station_sticks.py",
    r"button: Check list|button: Copter #": "test_station_preflight.py, test_station_group.py",
    r"button: Save group|select: Video resolution|Own address": "no test uses these yet",
    r"button: Terminate the flight": "test_app_payload_browser.py",
    r"button: (Start: |Cancel)": "test_station_calibration.py",
    r"button: (Check only|Flash)": "test_app_flash_browser.py, test_app_fleet_browser.py",
    r"button: (Motor #|Change the airframe|Reboot|Set NAME|Nothing)|FLTMODE#": "test_app_setup_browser.py",
}
#: Number of controls that each view has at least, without those of other tests.
MIN_USED = 60
#: Status codes of refusals, which Chromium logs as errors.
REFUSALS = re.compile(r"status of (400|403|404|409|501|502|504)")


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Any]]:
    """Two copters with all payloads: the station's URL, and a function for pages."""
    simulator = BackgroundSimulator(count=0)
    for _ in range(2):
        copter = simulator.simulation.add(
            VehicleType.COPTER,
            Firmware.ARDUPILOT,
            camera=True,
            gimbal=True,
            proximity=True,
            remote_id=True,
            rangefinders=(Rangefinder(common.MavSensorOrientation.PITCH_270),),
        )
        for name, value in STAY_ARMED.items():
            if name in copter.parameters:
                copter.parameters.set(name, value)
    make_ready(simulator.simulation)
    with ExitStack() as steps:
        steps.enter_context(simulator)
        url = steps.enter_context(web_station(tmp_path_factory.mktemp("station"), simulator.url))
        yield url, steps.enter_context(open_pages(REFUSALS))


@pytest.mark.parametrize("view", VIEWS)
def test_controls_are_used(world: tuple[str, Any], view: str) -> None:
    url, new_page = world
    page = new_page("about:blank")
    crawler = Crawler(page, re.compile("|".join(NOT_USED)))
    crawler.crawl(f"{url}#/{view}", "main")
    page.context.close()
    assert crawler.nameless == set()
    assert len(crawler.used) > MIN_USED
    assert crawler.unused == [], crawler.failures
