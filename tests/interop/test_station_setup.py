"""The set-up view in Chromium: parameters, modes, motors, estimator, shell, display, video transmitter."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mavstack.sim.background_controller import BackgroundFlightController
from tests.interop.setup_page import SetupPage, ready_vehicle, set_up
from tests.interop.station import PATIENT

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

#: The vehicle's sections for another firmware than that of ArduPilot or PX4.
FIRMWARE_SECTIONS = {"Flight modes", "Failsafes", "Estimator"}
REFUSAL = {"error": {"kind": "RemoteDenied", "text": "not while it is flying", "status_texts": []}}
#: Pulses of the mode switch and its positions.
SWITCH = {1000: 1, 1300: 2, 1700: 5}
HIDE = """() => {
  Object.defineProperty(document, 'visibilityState', { value: 'hidden', configurable: true })
  document.dispatchEvent(new Event('visibilitychange'))
}"""


def field(view: SetupPage, name: str) -> Any:
    return view.page.get_by_label(name, exact=True)


def enter(view: SetupPage, name: str, value: str) -> None:
    field(view, name).fill(value)
    field(view, name).press("Enter")


def check_values(view: SetupPage) -> None:
    """Find a parameter by its description, and change, undo and fail to change its value."""
    search = view.page.get_by_label("Search names and descriptions")
    search.fill("reaction low battery")
    view.page.get_by_text("1 parameter", exact=True).wait_for(timeout=PATIENT)
    choice = field(view, "BATT_FS_LOW_ACT")
    choice.select_option("2")
    view.page.get_by_text("before 0").wait_for(timeout=PATIENT)
    assert view.value("BATT_FS_LOW_ACT") == 2
    view.shown.button("Undo: set BATT_FS_LOW_ACT back to 0").click()
    view.page.get_by_text("before 0").wait_for(state="detached", timeout=PATIENT)
    assert (view.value("BATT_FS_LOW_ACT"), choice.input_value()) == (0, "0")
    view.page.route("**/parameters/BATT_FS_LOW_ACT", lambda route: route.fulfill(status=409, json=REFUSAL))
    choice.select_option("1")
    view.page.get_by_text("not while it is flying").wait_for(timeout=PATIENT)
    view.shown.wait_until(lambda: choice.input_value() == "0")
    view.page.unroute_all()
    search.fill("STAT_BOOTCNT")
    assert field(view, "STAT_BOOTCNT").is_disabled()
    assert view.page.locator(".parameter", has_text="read-only").count() == 1
    search.fill("FRAME_CLASS")
    enter(view, "FRAME_CLASS", "99")
    view.page.get_by_text("The largest value is 17.").wait_for(timeout=PATIENT)
    assert view.value("FRAME_CLASS") == 1
    enter(view, "FRAME_CLASS", "2")
    view.page.get_by_text("A change takes effect after a reboot.").wait_for(timeout=PATIENT)
    assert view.value("FRAME_CLASS") == 2


def check_bits(view: SetupPage) -> None:
    """Check two bits at once: neither change undoes the other."""
    view.page.get_by_label("Search names and descriptions").fill("FENCE_TYPE")
    bits = view.page.locator(".parameter .bits input")
    before = int(view.value("FENCE_TYPE"))
    for index in (0, 1):
        bits.nth(index).click()
    view.shown.wait_until(lambda: int(view.value("FENCE_TYPE")) == before ^ 0b11)
    view.shown.wait_until(lambda: field(view, "FENCE_TYPE").input_value() == str(before ^ 0b11))


def check_files(view: SetupPage, folder: Path) -> None:
    """Save all values, change the file, and write a part of the differences; a refusal is told."""
    view.page.get_by_label("Search names and descriptions").fill("")
    with view.page.expect_download() as waiting:
        view.page.get_by_label("Save as").select_option("mission-planner")
    saved = Path(waiting.value.path()).read_text("utf-8")
    assert "RTL_ALT,1500\n" in saved
    changed = folder / "changed.param"
    lines = saved.replace("RTL_ALT,1500", "RTL_ALT,1800").replace("STAT_BOOTCNT,", "STAT_BOOTCNT,7")
    changed.write_text(lines.replace("LAND_SPEED,50", "LAND_SPEED,60") + "NOT_THERE,1\n", "utf-8")
    view.page.locator("input[type=file][accept*=param]").set_input_files(changed)
    dialog = view.page.get_by_role("dialog")
    dialog.get_by_text("3 differ").wait_for(timeout=PATIENT)
    assert "1 are not on the vehicle" in dialog.inner_text()
    dialog.get_by_label("LAND_SPEED").uncheck()
    # A counter of another vehicle is not chosen by itself.
    dialog.get_by_role("button", name="Write 1 to the vehicle").wait_for(timeout=PATIENT)
    dialog.get_by_label("STAT_BOOTCNT").check()
    dialog.get_by_role("button", name="Write 2 to the vehicle").click()
    refused = view.page.get_by_role("alert").filter(has_text="1 parameter of Copter 1")
    refused.get_by_text("STAT_BOOTCNT:").wait_for(timeout=PATIENT)
    assert (view.value("RTL_ALT"), view.value("LAND_SPEED")) == (1800, 50)
    refused.get_by_role("button", name="Close").click()
    wrong = folder / "wrong.param"
    wrong.write_text("RTL_ALT,high\n", "utf-8")
    view.page.locator("input[type=file][accept*=param]").set_input_files(wrong)
    view.page.get_by_text("line 1: RTL_ALT,high is not a name and a number").wait_for(timeout=PATIENT)


def check_metadata_file(view: SetupPage, folder: Path) -> None:
    """Open a file with metadata: its descriptions are found."""
    facts = {"ACRO_": {"ArduCopter:ACRO_TRAINER": {"DisplayName": "Helps beginners", "Units": "parrots"}}}
    described = folder / "apm.pdef.json"
    described.write_text(json.dumps(facts), "utf-8")
    view.page.locator("input[type=file][accept*=json]").set_input_files(described)
    view.page.get_by_label("Search names and descriptions").fill("beginners")
    row = view.page.locator(".parameter")
    row.get_by_text("parrots").wait_for(timeout=PATIENT)
    assert row.count() == 1


def test_parameters(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("copter"), tmp_path) as view:
        view.wait_for_parameters()
        check_values(view)
        check_bits(view)
        check_files(view, tmp_path)
        check_metadata_file(view, tmp_path)


def test_modes_failsafes_and_sources_of_ardupilot(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("copter"), tmp_path) as view:
        view.wait_for_parameters()
        assert not {"Shell", "Video"} & set(view.sections())
        view.open("Flight modes")
        autopilot = view.simulator.vehicle.autopilot
        for pulse, position in SWITCH.items():
            view.simulator.call(lambda pulse=pulse: autopilot.radio.move(5, pulse))
            now = view.page.locator("li[aria-current=true]", has_text=f"Position {position}")
            now.wait_for(timeout=PATIENT)
        field(view, "Position 5").select_option(label="POSHOLD")
        view.shown.wait_until(lambda: view.value("FLTMODE5") == 16)
        view.open("Failsafes")
        field(view, "FS_GCS_ENABLE").select_option(label="1: Return")
        view.shown.wait_until(lambda: view.value("FS_GCS_ENABLE") == 1)
        view.open("Estimator")
        view.shown.hold("Source set 2")
        view.page.get_by_text("Source set 2 is selected").wait_for(timeout=PATIENT)
        texts = [each["text"] for each in view.server.get("vehicles/1/telemetry")["status_texts"]]
        assert "Using EKF Source Set 2" in texts


def test_modes_and_the_shell_of_px4(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("plane", "px4"), tmp_path) as view:
        view.wait_for_parameters()
        view.open("Flight modes")
        view.page.get_by_text("No channel of the transmitter selects modes.").wait_for(timeout=PATIENT)
        field(view, "Position 1").select_option(label="Mission")
        view.shown.wait_until(lambda: view.value("COM_FLTMODE1") == 3)
        view.open("Estimator")
        view.page.get_by_text("EKF2_HGT_REF").wait_for(timeout=PATIENT)
        assert view.shown.button("Source set 1").count() == 0
        view.open("Shell")
        output = view.page.get_by_label("Output of the shell")
        output.get_by_text("nsh>").wait_for(timeout=PATIENT)
        enter(view, "Command", "ver all")
        view.shown.wait_until(lambda: "PX4 version" in output.inner_text())
        field(view, "Command").press("ArrowUp")
        assert field(view, "Command").input_value() == "ver all"
        enter(view, "Command", "no_such_program")
        view.shown.wait_until(lambda: "no_such_program: command not found" in output.inner_text())


def hold_motor(view: SetupPage, motor: int) -> None:
    """Hold the button of a motor until it runs, and on for longer than one command lasts."""
    button = view.shown.button(f"Motor {motor}")
    button.hover(timeout=PATIENT)
    view.page.mouse.down()
    view.page.get_by_text(f"Motor {motor} runs.").wait_for(timeout=PATIENT)
    payload, vehicle = view.simulator.vehicle.autopilot.payload, view.simulator.vehicle
    started = view.simulator.call(lambda: vehicle.autopilot.now)
    view.shown.wait_until(lambda: view.simulator.call(lambda: vehicle.autopilot.now) > started + 4)
    assert view.simulator.call(lambda: payload.motor_tested) == motor


def wait_for_stop(view: SetupPage) -> None:
    payload = view.simulator.vehicle.autopilot.payload
    view.shown.wait_until(lambda: view.simulator.call(lambda: payload.motor_tested) == 0)
    view.page.locator(".guarded.active").wait_for(state="detached", timeout=PATIENT)


def test_motors_run_while_their_buttons_are_held(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, ready_vehicle("copter"), tmp_path) as view:
        view.wait_for_parameters()
        view.open("Motors and outputs")
        view.shown.button("Motor 1").wait_for(timeout=PATIENT)
        assert view.shown.button("Motor 1").is_disabled()
        view.page.get_by_label("The propellers are off.").check()
        hold_motor(view, 1)
        view.page.mouse.up()
        wait_for_stop(view)
        hold_motor(view, 2)
        view.page.evaluate(HIDE)
        wait_for_stop(view)
        view.page.mouse.up()
        hold_motor(view, 3)
        vehicle = view.simulator.vehicle
        view.simulator.call(lambda: vehicle.faults.inject("link off"))
        wait_for_stop(view)
        view.page.get_by_text("There is no contact with the vehicle.").wait_for(timeout=PATIENT)
        view.page.mouse.up()
        assert view.shown.button("Motor 3").is_disabled()


def test_display_and_transmitter_of_betaflight(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, BackgroundFlightController(), tmp_path) as view:
        view.wait_for_parameters()
        assert not (FIRMWARE_SECTIONS | {"Shell"}) & set(view.sections())
        view.open("Video")
        enter(view, "BF_VTX_CHANNEL", "3")
        view.shown.wait_until(lambda: view.value("BF_VTX_CHANNEL") == 3)
        enter(view, "BF_VTX_BAND", "9")
        view.page.get_by_text("The largest value is 8.").wait_for(timeout=PATIENT)
        screen = view.page.locator(".screen button")
        view.shown.wait_until(lambda: screen.count() == 4)
        chosen = screen.first
        chosen.click()
        column, row = (int(field(view, name).input_value()) for name in ("Column", "Row"))
        for _ in range(3):
            chosen.press("ArrowRight")
        chosen.press("ArrowDown")
        moved = (str(column + 3), str(row + 1))
        view.shown.wait_until(
            lambda: (field(view, "Column").input_value(), field(view, "Row").input_value()) == moved
        )
        name = view.page.get_by_label("Item", exact=True).input_value()
        bits = int(view.value(name))
        assert (bits & 31, bits >> 5 & 31) == (column + 3, row + 1)
        view.page.get_by_label("shown in this profile").uncheck()
        view.shown.wait_until(lambda: screen.count() == 3)
        assert int(view.value(name)) == bits & ~(1 << 11)
        enter(view, "Column", "99")
        view.shown.wait_until(lambda: field(view, "Column").input_value() == "29")


def test_inav_has_no_display_that_msp_describes(browser: Any, tmp_path: Path) -> None:
    with set_up(browser, BackgroundFlightController("inav"), tmp_path) as view:
        view.wait_for_parameters()
        assert not (FIRMWARE_SECTIONS | {"Shell", "Video"}) & set(view.sections())
