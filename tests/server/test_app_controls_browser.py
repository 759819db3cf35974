"""Controls of the fly view that other tests do not click: gripper, winch, Remote ID, spoken alerts."""

from __future__ import annotations

from contextlib import ExitStack
from urllib.request import urlopen

import pytest

from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.server.browsing import open_pages, web_station
from tests.sharing import shared_until_failure

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")

#: Spoken texts are kept in `spoken`.
VOICE = """
window.spoken = []
const voice = { speak: each => spoken.push(each.text), cancel: () => undefined }
Object.defineProperty(window, 'speechSynthesis', { value: voice })
"""


@shared_until_failure
def world(folder):
    """A copter with gripper, winch and Remote ID; the simulation, the URL, a function for pages."""
    simulator = BackgroundSimulator(count=0, speed=4)
    simulation = simulator.simulation
    copter = simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT, remote_id=True)
    for name in ("GRIP_ENABLE", "WINCH_TYPE"):
        copter.parameters.set(name, 1)
    with ExitStack() as steps:
        steps.enter_context(simulator)
        url = steps.enter_context(web_station(folder, simulator.url))
        yield simulation, url, steps.enter_context(open_pages())


def accepted(page, action: str) -> None:
    playwright.expect(page.get_by_text(f"{action}: accepted").last).to_be_visible(timeout=20_000)


@pytest.mark.parametrize("phone", [False, True], ids=["desktop", "phone"])
@pytest.mark.flight_cases(1)
def test_gripper_and_winch(world, phone: bool) -> None:
    simulation, url, new_page = world
    with urlopen(f"{url}api/vehicles/1/parameters", timeout=60) as answer:
        assert answer.status == 200  # they show that the copter has a gripper and a winch
    page = new_page(f"{url}#/fly", phone=phone, dark=not phone)
    playwright.expect(page.get_by_role("button", name="Choose a vehicle")).to_contain_text("Copter 1")
    if phone:
        page.get_by_role("tab", name="Payload").click()
    else:
        page.get_by_role("button", name="Equipment", exact=True).click()
    payload = simulation.vehicles[0].autopilot.payload
    for name, action in (("Close", "Close the gripper"), ("Open", "Open the gripper")):
        page.get_by_role("button", name=name, exact=True).click()
        accepted(page, action)
        assert payload.gripper_closed is (name == "Close")
    for name in ("Pay out", "Wind in", "Stop", "Run free"):
        page.get_by_role("button", name=name, exact=True).click()
        playwright.expect(page.get_by_role("alert")).to_have_count(0)


def test_remote_id_and_spoken_alerts(world) -> None:
    _, url, new_page = world
    page = new_page("about:blank")
    page.add_init_script(VOICE)
    page.goto(f"{url}#/fly")
    panel = page.get_by_role("region", name="Position and Remote ID")
    playwright.expect(panel).to_contain_text("arming")
    playwright.expect(panel).to_contain_text("satellites")
    page.locator("header").get_by_role("button", name="Settings").click()
    page.get_by_label("Speak alerts and changes of the flight mode").check()
    page.wait_for_function("spoken.some(text => text.startsWith('Copter 1: mode'))")
    page.get_by_label("Speak alerts and changes of the flight mode").uncheck()
