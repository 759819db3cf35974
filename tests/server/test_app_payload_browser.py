"""The controls of payloads and equipment in a browser: gimbal, camera, outputs, distances, VTOL, reboot."""

from __future__ import annotations

import json
import re
from contextlib import ExitStack
from functools import cache
from urllib.request import urlopen

import pytest

from mavstack.dialects import common
from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.motion.obstacles import Obstacle
from mavstack.sim.rangefinders import Rangefinder
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.server.browsing import PATIENT, hold, open_pages, web_station
from tests.sharing import shared_until_failure

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")

_DOWN = Rangefinder(common.MavSensorOrientation.PITCH_270)


@shared_until_failure
def world(folder):
    """A copter with a camera and a gimbal near a wall, and a PX4 VTOL; the URL, and a function for pages."""
    simulator = BackgroundSimulator(count=0)
    simulation = simulator.simulation
    simulation.add_obstacle(Obstacle(12.0, 0.0, 2.0, 10.0))
    simulation.add(
        VehicleType.COPTER,
        Firmware.ARDUPILOT,
        camera=True,
        gimbal=True,
        proximity=True,
        rangefinders=(_DOWN,),
    )
    simulation.add(VehicleType.VTOL, Firmware.PX4, proximity=False)
    with ExitStack() as steps:
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
    page = new_page(f"{url}#/fly")
    playwright.expect(page.get_by_role("button", name="Choose a vehicle")).to_contain_text("Copter 1")
    return page


def section(page, name: str):
    """Return a section of the right column, opened."""
    button = page.get_by_role("button", name=name, exact=True)
    if button.get_attribute("aria-expanded") == "false":
        button.click()
    return page.get_by_role("region", name=name, exact=True)


def gimbal(url: str) -> dict:
    with urlopen(f"{url}api/vehicles/1/gimbals/1", timeout=10) as answer:
        return json.load(answer)


def test_the_gimbal_is_controlled_and_pointed(world, page) -> None:
    panel = section(page, "Gimbal")
    panel.get_by_role("button", name="Take control").click()
    playwright.expect(panel).to_contain_text("The station is in control.")
    panel.get_by_role("button", name="Down").click()
    playwright.expect(panel.locator("dd").first).to_have_text("-90°")
    assert gimbal(world[0])["attitude"]["pitch"] == pytest.approx(-90, abs=1)
    panel.get_by_role("button", name="Centre").click()
    playwright.expect(panel.locator("dd").first).to_have_text("0°")
    panel.get_by_role("slider", name="Pitch").fill("-20")
    panel.get_by_role("slider", name="Yaw").fill("30")
    playwright.expect(panel.locator("dd").nth(1)).to_have_text("30°")
    for name in ("Look at home", "Look ahead", "Retract", "Release"):
        panel.get_by_role("button", name=name).click()
    playwright.expect(panel).to_contain_text("No component is in control.")
    panel.get_by_role("combobox", name="Keep a vehicle in view").select_option(label="VTOL 2")
    panel.get_by_role("button", name="Look", exact=True).click()
    playwright.expect(page.get_by_text("DO_SET_ROI_SYSID on 1/1 failed")).to_be_visible()


def test_the_camera_takes_photos_and_videos(page) -> None:
    panel = section(page, "Camera")
    images = panel.get_by_role("status")
    playwright.expect(images).to_have_text(re.compile(r"\d+ images? taken"))
    before = images.inner_text()
    panel.get_by_role("button", name="Take a photo").click()
    playwright.expect(images).not_to_have_text(before)
    panel.get_by_role("button", name="Series").click()
    panel.get_by_role("button", name="End the series").click()
    panel.get_by_role("button", name="Video", exact=True).click()
    panel.get_by_role("button", name="Record a video").click()
    playwright.expect(panel).to_contain_text("Recording for")
    panel.get_by_role("button", name="End the video").click()
    panel.get_by_role("button", name="Photo", exact=True).click()
    playwright.expect(panel.get_by_role("button", name="Photo", exact=True)).to_have_attribute(
        "aria-pressed", "true"
    )


def test_lens_tracking_settings_and_storage_of_the_camera(world, page) -> None:
    panel = section(page, "Camera")
    panel.get_by_role("slider", name="Zoom").fill("40")
    panel.get_by_role("button", name="Zoom the camera in").click()
    panel.get_by_role("slider", name="Focus").fill("20")
    panel.get_by_role("button", name="Autofocus").click()
    pad = panel.get_by_role("button", name=re.compile("^Track"))
    pad.click()
    playwright.expect(page.get_by_text("The camera tracks it.")).to_be_visible()
    panel.get_by_role("button", name="End the tracking").click()
    with urlopen(f"{world[0]}api/vehicles/1/cameras", timeout=10) as answer:
        (camera,) = json.load(answer)
    assert camera["status"]["zoom"] == pytest.approx(50)
    panel.get_by_text("Settings of the camera").click()
    panel.get_by_role("combobox", name="Camera mode").select_option("Video")
    playwright.expect(panel.get_by_role("button", name="Video", exact=True)).to_have_attribute(
        "aria-pressed", "true"
    )
    hold(page, panel.get_by_role("button", name="Reset all settings"))
    playwright.expect(panel.get_by_role("combobox", name="Camera mode")).to_have_value("Photo")
    hold(page, panel.get_by_role("button", name="Erase"), 2300)
    playwright.expect(page.get_by_text("The storage was erased.")).to_be_visible()


def test_outputs_are_set(page) -> None:
    panel = section(page, "Equipment")
    panel.get_by_role("button", name="Set the servo").click()
    playwright.expect(page.get_by_text("Servo: accepted")).to_be_visible()
    panel.get_by_role("spinbutton", name="Relay").fill("9")
    panel.get_by_role("button", name="On", exact=True).click()
    playwright.expect(panel.get_by_role("alert")).to_contain_text("Relay on was refused")
    panel.get_by_role("button", name="Dismiss").click()
    panel.get_by_role("button", name="Beep", exact=True).click()
    playwright.expect(page.get_by_text("Beep: accepted")).to_be_visible()


def test_distances_are_shown(page) -> None:
    panel = section(page, "Distances")
    playwright.expect(panel).to_contain_text("Below")
    playwright.expect(panel).to_contain_text(re.compile(r"Nearest: (9|10)\.\d m"))
    panel.get_by_role("img", name=re.compile("Obstacles around")).wait_for()


def test_extended_parameters_are_set(world, page) -> None:
    page.goto(f"{world[0]}#/setup")
    page.get_by_role("button", name="Payload parameters").click()
    page.get_by_role("button", name="Download").click()
    page.get_by_role("spinbutton", name="CAM_EV").fill("1")
    page.get_by_role("button", name="Set CAM_EV").click()
    playwright.expect(page.get_by_role("button", name="Set CAM_EV")).to_be_disabled()
    playwright.expect(page.get_by_role("spinbutton", name="CAM_EV")).to_have_value("1")
    page.goto(f"{world[0]}#/fly")


def test_a_vtol_has_its_own_controls_on_a_phone(world) -> None:
    url, new_page = world
    page = new_page(f"{url}#/fly", phone=True, dark=False)
    page.get_by_role("button", name="Choose a vehicle").click()
    page.get_by_role("option", name="VTOL 2").click()
    playwright.expect(page.get_by_role("button", name="Fly on the wing")).to_be_disabled()
    page.get_by_role("tab", name="Payload").click()
    page.get_by_role("button", name="Set the actuator").wait_for()
    playwright.expect(page.get_by_role("region", name="Gimbal")).to_have_count(0)
    page.get_by_role("tab", name="Actions").click()
    page.locator("summary", has_text="More").click()
    hold(page, page.get_by_role("button", name="Reboot"), 1800)
    playwright.expect(page.get_by_text("Reboot: accepted")).to_be_visible()


@pytest.mark.nightly
def test_a_vtol_changes_its_flight_and_is_terminated(world) -> None:
    url, new_page = world
    page = new_page(f"{url}#/fly")
    page.get_by_role("button", name="Choose a vehicle").click()
    page.get_by_role("option", name="VTOL 2").click()
    hold(page, page.get_by_role("button", name="Arm", exact=True), 1800)
    playwright.expect(page.get_by_text("Arm: accepted")).to_be_visible()
    hold(page, page.get_by_role("button", name="Take off", exact=True), 1800)
    playwright.expect(page.get_by_text("Take off: accepted")).to_be_visible(timeout=PATIENT)
    # PX4 holds at the end of a takeoff.
    playwright.expect(page.get_by_role("button", name=re.compile("VTOL 2 LOITER"))).to_be_visible(
        timeout=2 * PATIENT
    )
    for name in ("Fly on the wing", "Hover"):
        button = page.get_by_role("button", name=name, exact=True)
        playwright.expect(button).to_be_enabled(timeout=PATIENT)
        button.click()
        playwright.expect(page.get_by_text(f"{name}: accepted")).to_be_visible(timeout=PATIENT)
    page.locator("summary", has_text="More").click()
    button = page.get_by_role("button", name="Terminate the flight", exact=True)
    hold(page, button, 1000)
    playwright.expect(page.get_by_text("Terminate the flight: accepted")).to_have_count(0)
    hold(page, button, 3300)
    playwright.expect(page.get_by_text("Terminate the flight: accepted")).to_be_visible()
