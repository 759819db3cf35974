"""The swarm, the simulators, firmware and saved parameters in a browser."""

from __future__ import annotations

import json
import re
from contextlib import ExitStack
from functools import cache

import pytest

from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.fleet import Fleet
from tests.server.browsing import hold, open_pages, web_station
from tests.sharing import shared_until_failure
from tests.swarm.shows.samples import skyc

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")


@shared_until_failure
def world(folder):
    """Three copters; the URL of their station, and a function for pages."""
    with ExitStack() as steps:
        simulator = BackgroundSimulator(count=0, speed=4)
        Fleet(count=3).add_to(simulator.simulation)
        steps.enter_context(simulator)
        url = steps.enter_context(web_station(folder, simulator.url))
        yield url, steps.enter_context(open_pages())


@pytest.fixture
def page(world):
    return page_of(world)


@cache
def page_of(world):
    """Return the page that the tests of these vehicles share."""
    url, new_page = world
    page = new_page(f"{url}#/swarm")
    playwright.expect(page.get_by_role("group", name="Members").get_by_role("checkbox")).to_have_count(3)
    return page


def test_parameters_are_saved_and_firmware_is_checked(world) -> None:
    # First: parameters are saved on the ground only, and the other tests leave the vehicles in the air.
    url, new_page = world
    page = new_page(f"{url}#/setup")

    def unsaved(route) -> None:
        answer = route.fetch()
        found = answer.json()
        if "parameters" in found:
            found["parameters"][0]["saved"] = False
        route.fulfill(json=found, status=answer.status)

    page.route(re.compile("/api/tasks/[0-9]+/result"), unsaved)
    page.get_by_text("1 parameter is not yet saved").wait_for(timeout=60_000)
    page.get_by_role("button", name="Save", exact=True).click()
    playwright.expect(page.get_by_text("The parameters are saved on the vehicle.")).to_be_visible()
    playwright.expect(page.get_by_text("not yet saved")).to_have_count(0)
    page.get_by_role("button", name="Firmware", exact=True).click()
    # It is simulated: its version, by which the page learns that, comes some seconds later.
    playwright.expect(page.get_by_text("has no bootloader")).to_be_visible()
    damaged = {"name": "copter.apj", "mimeType": "", "buffer": b"junk"}
    page.get_by_label("File of the firmware").set_input_files([damaged])
    playwright.expect(page.get_by_role("alert")).to_contain_text("copter.apj")
    playwright.expect(page.get_by_role("button", name="Flash", exact=True)).to_be_disabled()


def test_a_formation_is_flown_and_stopped(page) -> None:
    page.get_by_role("spinbutton", name="Spacing").fill("12")
    page.get_by_role("spinbutton", name="Altitude").fill("15")
    page.get_by_role("combobox", name="Formation").select_option("line")
    page.get_by_label("Arm and take off first").check()
    hold(page, page.get_by_role("button", name="Form up"))
    panel = page.get_by_role("region", name="Smallest separation")
    playwright.expect(panel).to_contain_text("The swarm is flying", timeout=30_000)
    playwright.expect(panel).to_contain_text("between", timeout=60_000)
    playwright.expect(panel).to_contain_text("No formation is flown.", timeout=90_000)
    distance = float(panel.locator(".value").inner_text().split()[0])
    assert distance == pytest.approx(12, abs=2)
    page.get_by_role("button", name="45° right").click()
    playwright.expect(panel).to_contain_text("The swarm is flying: rotate", timeout=20_000)
    page.get_by_role("button", name="Stop", exact=True).click()
    playwright.expect(panel).to_contain_text("No formation is flown.", timeout=20_000)


@pytest.mark.nightly
def test_a_search_is_divided(page) -> None:
    page.get_by_label("Map of the swarm").first.click(position={"x": 300, "y": 400})
    page.get_by_role("button", name="Plan the search").click()
    playwright.expect(page.get_by_role("listitem")).to_have_count(3)
    hold(page, page.get_by_role("button", name="Upload and fly"))
    playwright.expect(page.get_by_text("Each member has its share")).to_be_visible(timeout=60_000)
    hold(page, page.get_by_role("button", name="Land all"))


def test_a_show_is_checked_and_played(page) -> None:
    buffer = skyc(6, radius=20.0)
    page.get_by_label("Open a show").set_input_files(
        {"name": "circle.skyc", "mimeType": "application/zip", "buffer": buffer}
    )
    panel = page.get_by_role("region", name="Show")
    playwright.expect(panel).to_contain_text("Circle: 6 vehicles")
    playwright.expect(panel).to_contain_text("All limits are kept.")
    time = panel.get_by_role("slider", name="Time of the show")
    time.fill("30")
    side = panel.get_by_role("img", name="The show from the side")
    heights = [float(each.get_attribute("cy")) for each in side.locator("circle").all()]
    assert heights == pytest.approx([-10.0] * 6)
    panel.get_by_role("button", name="Play the show").click()
    playwright.expect(time).to_have_value(re.compile("^3[1-9]|^[45]"))
    panel.get_by_role("button", name="Pause the show").click()
    panel.get_by_role("button", name="Close the show").click()
    playwright.expect(time).to_have_count(0)
    unsafe = {"name": "near.skyc", "mimeType": "application/zip", "buffer": skyc(8, radius=5.0)}
    page.get_by_label("Open a show").set_input_files(unsafe)
    playwright.expect(panel.get_by_role("alert")).to_contain_text("m apart at")


@pytest.mark.nightly
def test_a_show_is_flown_paused_and_stopped(page) -> None:
    page.get_by_label("Open a show").set_input_files(
        {"name": "circle.skyc", "mimeType": "application/zip", "buffer": skyc(3, radius=20.0)}
    )
    panel = page.get_by_role("region", name="Show")
    fly = panel.get_by_role("button", name="Fly the show")
    playwright.expect(panel).to_contain_text("The show needs 3 vehicles; 0 chosen.")
    playwright.expect(fly).to_be_disabled()
    for box in panel.get_by_role("group", name="Vehicles that fly it").get_by_role("checkbox").all():
        box.check()
    panel.get_by_label("Arm and take off first").check()
    hold(page, fly)
    playwright.expect(panel).to_contain_text("The show is flown.", timeout=60_000)
    panel.get_by_role("button", name="Pause").click()
    playwright.expect(panel).to_contain_text("The show is paused", timeout=20_000)
    hold(page, panel.get_by_role("button", name="Continue"))
    playwright.expect(panel).to_contain_text("The show is flown.", timeout=20_000)
    panel.get_by_role("button", name="Stop the show").click()
    playwright.expect(panel.get_by_role("button", name="Fly the show")).to_be_visible(timeout=20_000)
    panel.get_by_role("button", name="Close the show").click()


def test_a_simulator_is_started_disturbed_and_stopped(world) -> None:
    url, new_page = world
    page = new_page(f"{url}#/fly", phone=True, dark=False)

    def anywhere(route) -> None:
        body = route.request.post_data_json if route.request.method == "POST" else None
        free = None if body is None else json.dumps({**body, "listen": "udpin://127.0.0.1:0"})
        route.continue_(post_data=free)

    page.route("**/api/simulators", anywhere)
    page.get_by_role("button", name="Choose a vehicle").wait_for()
    page.keyboard.press("l")
    page.get_by_role("combobox", name="Firmware").select_option("ardupilot")
    page.get_by_role("combobox", name="Vehicle", exact=True).select_option("rover")
    page.get_by_role("button", name="Start a simulator").click()
    simulator = page.get_by_role("article", name="Simulator 1")
    playwright.expect(simulator.get_by_role("status")).to_contain_text("ArduPilot")
    simulator.get_by_role("button", name="Pause").click()
    simulator.get_by_role("button", name="One step").click()
    simulator.get_by_role("combobox", name="Inject a fault").select_option("gps-lost")
    simulator.get_by_role("button", name="gps-lost").click()
    playwright.expect(simulator.get_by_role("button", name="gps-lost")).to_have_count(0)
    simulator.get_by_role("button", name="Stop simulator 1").click()
    playwright.expect(simulator).to_have_count(0)
