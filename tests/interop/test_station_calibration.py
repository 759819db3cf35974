"""The calibrations in Chromium: each is run to its end by a user's clicks; one is cancelled, one refused."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from mavstack.sim.background_controller import BackgroundFlightController
from tests.interop.setup_page import SetupPage, ready_vehicle, set_up
from tests.interop.station import PATIENT, PHONE

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

DONE = "The calibration is done."
POSES = ("level", "on its left side", "on its right side", "nose down", "nose up", "on its back")
ROLL, PITCH, THROTTLE, YAW, SWITCH = range(1, 6)


def start(view: SetupPage, title: str, *, held: bool = False) -> None:
    """Start a calibration, by a button that is held if motors can run."""
    view.open("Calibration")
    if held:
        view.shown.hold(f"Start: {title}")
    else:
        view.shown.button(f"Start: {title}").click()


def task(view: SetupPage) -> str:
    """Return the task that the guide shows."""
    return str(view.page.locator(".task").inner_text())


def wait_for_task(view: SetupPage, words: str) -> None:
    view.page.locator(".task", has_text=words).wait_for(timeout=PATIENT)


def confirm(view: SetupPage) -> None:
    view.shown.button("Done").click(timeout=PATIENT)


def finish(view: SetupPage) -> None:
    """Wait until the calibration is done, and close the guide."""
    view.page.get_by_text(DONE, exact=True).wait_for(timeout=PATIENT)
    view.shown.button("Close").click()
    view.page.get_by_text(DONE, exact=True).wait_for(state="detached", timeout=PATIENT)


def move(view: SetupPage, **channels: int) -> None:
    """Move sticks and switches of the transmitter."""
    radio = view.simulator.vehicle.autopilot.radio
    for name, pulse in channels.items():
        view.simulator.call(lambda name=name, pulse=pulse: radio.move(globals()[name], pulse))


def pulse_of(view: SetupPage, channel: int) -> int:
    meter = view.page.get_by_role("meter", name=f"Channel {channel}", exact=True)
    return int(meter.get_attribute("aria-valuenow") or 0)


def kinds(view: SetupPage) -> list[str]:
    """Return the titles of the calibrations that are offered."""
    view.open("Calibration")
    view.page.locator(".kinds h2").first.wait_for(timeout=PATIENT)
    titles: list[str] = view.page.locator(".kinds h2").all_inner_texts()
    return titles


def calibrate_accelerometer(view: SetupPage) -> None:
    """Take the six poses, of which the page shows the one that is asked for."""
    start(view, "Accelerometer")
    for number, pose in enumerate(POSES):
        now = view.page.locator(".poses li[aria-current=step]", has_text=pose)
        now.wait_for(timeout=PATIENT)
        assert view.page.locator(".poses li.done").count() == number
        wait_for_task(view, f"Place the vehicle {pose}")
        confirm(view)
    view.page.get_by_text(DONE, exact=True).wait_for(timeout=PATIENT)
    assert view.page.get_by_text("It takes effect after a reboot.").is_visible()
    view.shown.button("Close").click()


def calibrate_compass(view: SetupPage) -> None:
    """Turn the vehicle, and see the progress grow."""
    start(view, "Compass")
    wait_for_task(view, "Rotate the vehicle slowly")
    progress = view.page.locator(".guide progress")
    first = float(progress.get_attribute("value", timeout=PATIENT))
    view.page.wait_for_function(
        "first => document.querySelector('.guide progress')?.value > first + 20", arg=first
    )
    view.page.get_by_text("Compass 1: fitness 5.0").wait_for(timeout=PATIENT)
    finish(view)


def calibrate_radio(view: SetupPage) -> None:
    """Move all sticks and a switch to their ends, and center them."""
    start(view, "Radio control")
    wait_for_task(view, "Move all sticks")
    assert pulse_of(view, ROLL) == 1500
    for pulse in (1012, 1990):
        move(view, ROLL=pulse, PITCH=pulse, THROTTLE=pulse, YAW=pulse, SWITCH=pulse)
        view.shown.wait_until(lambda pulse=pulse: pulse_of(view, SWITCH) == pulse)
    confirm(view)
    wait_for_task(view, "Center the sticks")
    move(view, ROLL=1505, PITCH=1500, THROTTLE=1015, YAW=1500)
    view.shown.wait_until(lambda: (pulse_of(view, ROLL), pulse_of(view, THROTTLE)) == (1505, 1015))
    confirm(view)
    row = view.page.get_by_role("row", name="1 1012 1505 1990", exact=True)
    row.wait_for(timeout=PATIENT)
    finish(view)
    assert [view.value(f"RC1_{name}") for name in ("MIN", "TRIM", "MAX")] == [1012, 1505, 1990]
    assert view.value(f"RC{SWITCH}_MAX") == 1990


def calibrate_compass_motor(view: SetupPage) -> None:
    """Raise the throttle, whose effect is drawn; before, the vehicle refuses with its reason."""
    move(view, THROTTLE=1200)
    start(view, "Compass and motors", held=True)
    view.page.get_by_text("The calibration failed.").wait_for(timeout=PATIENT)
    assert "Throttle not zero" in view.page.locator(".reason").first.inner_text()
    move(view, THROTTLE=1000)
    start(view, "Compass and motors", held=True)
    wait_for_task(view, "Raise the throttle slowly")
    throttle = view.page.locator("dl div", has_text="Throttle").locator("dd")
    view.shown.wait_until(lambda: throttle.inner_text() == "50 %")
    chart = view.page.get_by_role("img", name="Interference and current by the throttle")
    line = chart.locator("polyline.interference").get_attribute("points")
    assert len(line.split()) > 3
    assert view.page.locator("dl .interference dd").inner_text() == "12 %"
    assert view.page.get_by_text("Disarm the vehicle before you calibrate.").count() == 0
    confirm(view)
    finish(view)


@pytest.mark.nightly
def test_a_copter_with_ardupilot(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("copter"), tmp_path) as view:
        assert kinds(view) == [
            "Accelerometer",
            "Level",
            "Gyroscope",
            "Compass",
            "Radio control",
            "Barometer",
            "Speed controllers",
            "Compass and motors",
        ]
        calibrate_accelerometer(view)
        view.shown.hold("Reboot")
        view.page.get_by_text("A change takes effect after a reboot.").wait_for(state="detached")
        for kind in ("Level", "Gyroscope", "Barometer"):
            start(view, kind)
            finish(view)
        calibrate_compass(view)
        calibrate_radio(view)
        calibrate_compass_motor(view)
        start(view, "Speed controllers", held=True)
        wait_for_task(view, "connect the battery")
        finish(view)
        assert view.value("ESC_CALIBRATION") == 0


def test_values_that_a_calibration_changed_are_shown(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("copter", "px4"), tmp_path) as view:
        view.wait_for_parameters()
        search = view.page.get_by_label("Search names and descriptions")
        search.fill("CAL_GYRO0_XOFF")
        shown = view.page.get_by_label("CAL_GYRO0_XOFF", exact=True)
        assert float(shown.input_value()) == 0
        # No announcement tells this change.
        view.simulator.simulation.vehicles[0].parameters.table["CAL_GYRO0_XOFF"].value = 0.25
        start(view, "Gyroscope")
        finish(view)
        view.open("Parameters")
        search.fill("CAL_GYRO0_XOFF")
        view.shown.wait_until(lambda: float(shown.input_value()) == 0.25)


def test_a_plane_with_ardupilot(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("plane"), tmp_path) as view:
        assert not {"Speed controllers", "Compass and motors"} & set(kinds(view))
        start(view, "Airspeed")
        wait_for_task(view, "Keep the wind off the pitot tube.")
        finish(view)


@pytest.mark.nightly
def test_a_plane_with_px4(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("plane", "px4"), tmp_path, PHONE, "light") as view:
        assert "Compass and motors" not in kinds(view)
        start(view, "Airspeed")
        wait_for_task(view, "Ensure sensor is not measuring wind")
        wait_for_task(view, "Blow into front of pitot")
        finish(view)
        start(view, "Accelerometer")
        view.page.locator(".poses li[aria-current=step]", has_text="nose up").wait_for(timeout=PATIENT)
        view.page.locator(".poses li.done", has_text="nose up").wait_for(timeout=PATIENT)
        assert view.shown.button("Done").count() == 0
        finish(view)
        start(view, "Speed controllers", held=True)
        wait_for_task(view, "Connect battery now")
        finish(view)
        for kind in ("Level", "Gyroscope", "Barometer"):
            start(view, kind)
            finish(view)
        start(view, "Compass")
        view.page.locator(".poses li[aria-current=step]").first.wait_for(timeout=PATIENT)
        view.shown.button("Cancel").click()
        view.page.get_by_text("The calibration was cancelled.").wait_for(timeout=PATIENT)
        state = view.simulator.vehicle.autopilot.profile.state
        view.shown.wait_until(lambda: view.simulator.call(lambda: state.calibrating) == "")


def test_a_calibration_outlives_the_page_and_ends_with_the_link(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("copter"), tmp_path) as view:
        start(view, "Accelerometer")
        confirm(view)
        wait_for_task(view, "Place the vehicle on its left side")
        view.page.reload()
        view.open("Calibration")
        wait_for_task(view, "Place the vehicle on its left side")
        confirm(view)
        wait_for_task(view, "Place the vehicle on its right side")
        vehicle = view.simulator.vehicle
        view.simulator.call(lambda: vehicle.faults.inject("link off"))
        view.page.get_by_text("The calibration failed.").wait_for(timeout=PATIENT)
        assert "it fell silent" in view.page.locator(".reason").first.inner_text()
        view.shown.wait_until(lambda: view.shown.button("Start: Level").is_disabled())
        view.simulator.call(lambda: vehicle.faults.inject("link on"))
        start(view, "Accelerometer")
        wait_for_task(view, "Place the vehicle on its right side")
        view.shown.button("Cancel").click()
        view.page.get_by_text("The vehicle cannot cancel it").wait_for(timeout=PATIENT)


@pytest.mark.nightly
def test_a_copter_with_betaflight(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, BackgroundFlightController(speed=4), tmp_path) as view:
        assert kinds(view) == ["Accelerometer", "Compass"]
        start(view, "Accelerometer")
        wait_for_task(view, "Place the vehicle level")
        assert view.page.locator(".poses").count() == 0
        finish(view)
