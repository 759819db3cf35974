"""Every control of every view is used, with each firmware, on a desktop and a phone.

A console must be free of errors, and each control must be reached, have a name and have an effect. The
interop tests use some controls of each view; all of them are used nightly.
"""

from __future__ import annotations

import re
from contextlib import ExitStack
from functools import cache
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.background_controller import BackgroundFlightController
from mavstack.sim.rangefinders import Rangefinder
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.interop.control_crawler import MAX_ACTIONS, Report, crawl
from tests.server.browsing import open_pages, web_station
from tests.server.web_serial import PORT
from tests.sharing import shared_until_failure
from tests.sim.msp.peer import Peer
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(600)]

#: The views that show vehicles, and the parts of the page around them.
VIEWS = ("fly", "plan", "setup", "inspect", "logs", "dashboards", "swarm", "shell")
#: The views that are the same for all vehicles, with the firmware of the station.
OTHER_VIEWS = (("router", "ardupilot"), ("generator", "px4"), ("msp", "betaflight"))
FIRMWARES = ("ardupilot", "px4", "betaflight")
#: The views in which iNav differs from Betaflight: it navigates and has plans.
INAV_VIEWS = tuple((view, "inav") for view in ("fly", "plan", "setup"))
SHELL = ".shell > :not(main)"
#: Firmware and device of each view in the interop tests; the router has no controls.
SLICE = (
    ("fly", "px4", True),
    ("plan", "ardupilot", True),
    ("setup", "betaflight", False),
    ("inspect", "px4", False),
    ("logs", "ardupilot", True),
    ("dashboards", "ardupilot", False),
    ("generator", "px4", False),
    ("swarm", "ardupilot", False),
    ("msp", "betaflight", True),
    ("shell", "px4", True),
)
#: Number of actions of each view in the interop tests.
FEW_ACTIONS = 8
#: Parameters that keep a vehicle on the ground armed.
STAY_ARMED = {"DISARM_DELAY": 0, "COM_DISARM_PRFLT": -1}
#: The picker shows a vehicle.
READY = "button:enabled:has-text('Choose a vehicle:')"
#: Controls that are not used here: those that leave the page, and those that need a flight, a gamepad or
#: another window, with the tests that use them.
NOT_USED = {
    r"button: (Disconnect|Sign out)$": "test_app_msp_browser.py, test_station_sessions.py",
    r"^a: .*(Download|\.(mp4|tlog|mcap))": "test_station_video.py",
    r"button: Start: ": "test_station_calibration.py",
    r"button: (Terminate the flight|Dismiss)$": "test_app_payload_browser.py",
    r"button: Disarm$": "test_station_fly.py",
    r"summary: Settings of the controller": "test_station_sticks.py",
    r"button: (Add them|Remove.*)$": "test_station_dashboards.py, test_station_plan.py",
}
EXCLUDED = "|".join(NOT_USED)
#: Controls that need a file, a choice or a board before they are enabled, with the tests that use them.
NEVER_ENABLED = {
    r"button: Download$": "test_station_maps.py: an area",
    r"button: Motor #": "test_station_setup.py: the propellers are off",
    r"button: Nothing was changed here": "test_app_setup_browser.py: a change",
    r"button: Set NAME$": "test_station_setup.py: a change",
    r"button: (Check only|Flash|Flash the board at this computer)$": "test_app_flash_browser.py: a file",
    r"button: Generate and download$": "test_app_browser.py: a language",
    r"button: Choose the port$": "test_station_dashboards.py: a source",
    r"button: Choose two vehicles or more$": "test_app_division_browser.py: the vehicles",
    r"button: (Upload|Clear on vehicle)$": "test_station_plan.py: a vehicle that has plans",
    r"button: Connecting": "test_app_msp_browser.py: a connection that is made",
}
IDLE = re.compile("|".join(NEVER_ENABLED))
#: Status codes of refusals, which Chromium logs as errors.
REFUSALS = re.compile(r"status of (400|403|404|409|429|501|502|503|504)")


class World:
    """The stations of the module, each with two vehicles or a flight controller, and a browser."""

    def __init__(self, steps: ExitStack, folder: Path) -> None:
        self._steps, self._folder = steps, folder
        self.new_page = steps.enter_context(open_pages(REFUSALS))
        self.url_of = cache(self._url_of)

    def _url_of(self, firmware: str) -> str:
        vehicle = self._steps.enter_context(vehicle_of(firmware))
        folder = self._folder / firmware
        folder.mkdir()
        return str(self._steps.enter_context(web_station(folder, vehicle.url)))

    def crawl(self, view: str, firmware: str, phone: bool, actions: int = MAX_ACTIONS) -> Report:
        """Use the controls of a view."""
        url, page = self.url_of(firmware), self.new_page("about:blank", phone=phone)
        if view == "msp":
            expose_controller(page)
        address = f"{url}#/{'fly' if view == 'shell' else view}"
        root = SHELL if view == "shell" else "main"
        try:
            return crawl(page, address, root, ready=READY, excluded=EXCLUDED, actions=actions)
        finally:
            page.context.close()


@shared_until_failure
def world(folder: Path) -> Iterator[World]:
    with ExitStack() as steps:
        yield World(steps, folder)


def vehicle_of(firmware: str) -> BackgroundSimulator | BackgroundFlightController:
    """Return a flight controller, or two copters with all payloads."""
    if firmware in {"betaflight", "inav"}:
        return BackgroundFlightController(firmware)
    simulator = BackgroundSimulator(count=0)
    for _ in range(2):
        copter = simulator.simulation.add(
            VehicleType.COPTER,
            Firmware(firmware),
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
    return simulator


def expose_controller(page: Any) -> None:
    """Let the page reach a flight controller by WebSerial."""
    peer = Peer("betaflight")

    def exchange(data: list[int]) -> list[int]:
        peer.run(0.05)
        return list(peer.send(bytes(data)))

    page.expose_function("exchange", exchange)
    page.add_init_script(PORT)


@pytest.mark.parametrize(("view", "firmware", "phone"), SLICE, ids=[each[0] for each in SLICE])
def test_controls_of_each_view(world: World, view: str, firmware: str, phone: bool) -> None:
    report = world.crawl(view, firmware, phone, FEW_ACTIONS)
    assert report.faults == []
    assert report.used


@pytest.mark.nightly
@pytest.mark.parametrize("phone", [False, True], ids=["desktop", "phone"])
@pytest.mark.parametrize(
    ("view", "firmware"),
    [*((view, firmware) for firmware in FIRMWARES for view in VIEWS), *INAV_VIEWS, *OTHER_VIEWS],
)
def test_every_control(world: World, firmware: str, view: str, phone: bool) -> None:
    report = world.crawl(view, firmware, phone)
    print(f"{len(report.used)} of {len(report.seen)} used; never enabled: {report.idle}")
    print(*report.actions, *report.faults, sep="\n")
    assert report.faults == []
    assert [each for each in report.idle if not IDLE.match(each)] == []


#: A page with one control of each fault, and sound ones.
FAULTY = """
<main>
  <button onclick="document.title = 'used'">Sound</button>
  <button>Does nothing</button>
  <button onclick="document.title = 'nameless'"></button>
  <div style="position: relative">
    <button onclick="document.title = 'covered'">Covered</button>
    <div style="position: absolute; inset: 0"></div>
  </div>
  <label><input type="checkbox"> Choice</label>
  <input aria-label="Text">
  <select aria-label="List"><option>a</option><option>b</option></select>
  <button disabled>Never enabled</button>
</main>
"""


def test_the_crawler_finds_faults(world: World) -> None:
    page = world.new_page("about:blank")
    page.route("http://faulty.test/", lambda route: route.fulfill(body=FAULTY, content_type="text/html"))
    report = crawl(page, "http://faulty.test/")
    page.context.close()
    assert report.faults == [
        "covered by div.: button: Covered",
        "dead: button: Does nothing",
        *report.faults[2:],
    ]
    assert [each[:17] for each in report.faults[2:]] == ["nameless: button:"]
    assert report.idle == ["button: Never enabled"]
    assert {"button: Sound", "checkbox: Choice", "text: Text", "select: List"} <= set(report.used)
