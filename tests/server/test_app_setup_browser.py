"""The pages of the set-up in a browser: check list, airframe, ports, outputs, receiver, battery, tuning."""

from __future__ import annotations

import re
from contextlib import ExitStack
from functools import cache

import pytest

from mavstack.msp.messages.config import BAUD_RATES, INAV_BAUD_RATES, SerialConfig
from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.background_controller import BackgroundFlightController
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.server.browsing import hold, open_pages, web_station
from tests.sharing import shared_until_failure

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")


@shared_until_failure
def world(folder):
    """A copter of ArduPilot and one of PX4; the simulator, the URL, and a function for pages."""
    simulator = BackgroundSimulator(count=0)
    simulator.simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT)
    simulator.simulation.add(VehicleType.COPTER, Firmware.PX4)
    with ExitStack() as steps:
        steps.enter_context(simulator)
        url = steps.enter_context(web_station(folder, simulator.url))
        yield simulator, url, steps.enter_context(open_pages())


@pytest.fixture
def page(world):
    return page_of(world)


@cache
def page_of(world):
    """Return the page that the tests of these vehicles share."""
    _, url, new_page = world
    page = new_page(f"{url}#/setup")
    playwright.expect(page.get_by_role("button", name="Choose a vehicle")).to_contain_text("Copter 1")
    return page


def open_section(page, name: str) -> None:
    page.get_by_role("navigation", name="Set-up").get_by_role("button", name=name, exact=True).click()


def wait_until(page, condition) -> None:
    while not condition():
        page.wait_for_timeout(100)


def test_the_check_list_leads_to_what_is_missing(page) -> None:
    open_section(page, "First flight")
    playwright.expect(page.get_by_role("status").first).to_contain_text("missing")
    battery = page.get_by_role("listitem").filter(has_text="low battery")
    playwright.expect(battery).to_contain_text("nothing happens")
    battery.get_by_role("button", name="Open Failsafes").click()
    page.get_by_role("heading", name="Failsafes").wait_for()
    field = page.get_by_label("BATT_FS_LOW_ACT")
    field.wait_for()
    if field.evaluate("field => field.tagName") == "SELECT":
        field.select_option("2")
    else:
        field.fill("2")
        field.press("Enter")
    page.get_by_role("button", name=re.compile("Undo: set BATT_FS_LOW_ACT")).wait_for()
    open_section(page, "First flight")
    playwright.expect(battery).to_contain_text("the vehicle acts")


def test_a_change_of_the_airframe_is_shown_first(world, page) -> None:
    copter = world[0].simulation.vehicles[0]
    open_section(page, "Airframe")
    change = page.get_by_role("button", name="Change the airframe")
    playwright.expect(page.get_by_text("The vehicle is set up like this already.")).to_be_visible()
    playwright.expect(change).to_be_disabled()
    page.get_by_role("combobox", name="Airframe").select_option(label="2: hexa")
    page.get_by_role("combobox", name="Arrangement of the motors").select_option(label="0: plus")
    playwright.expect(page.get_by_text("Sets FRAME_CLASS = 2, FRAME_TYPE = 0.")).to_be_visible()
    assert copter.parameters["FRAME_CLASS"] == 1
    boots = copter.boots
    hold(page, change, 1800)
    playwright.expect(page.get_by_text("The airframe is now: hexa, plus.")).to_be_visible()
    playwright.expect(change).to_be_disabled()
    assert (copter.parameters["FRAME_CLASS"], copter.boots) == (2, boots + 1)


def test_serial_ports_are_set_and_need_a_reboot(world, page) -> None:
    open_section(page, "Serial ports")
    page.get_by_role("combobox", name="Protocol of SERIAL2").select_option(label="rangefinder")
    page.get_by_role("combobox", name="Bits per second of SERIAL2").select_option("115200")
    page.get_by_role("button", name="Set SERIAL2").click()
    playwright.expect(page.get_by_role("button", name="Set SERIAL2")).to_be_disabled()
    parameters = world[0].simulation.vehicles[0].parameters
    assert (parameters["SERIAL2_PROTOCOL"], parameters["SERIAL2_BAUD"]) == (9, 115)
    playwright.expect(page.get_by_text("A change takes effect after a reboot.").last).to_be_visible()
    boots = world[0].simulation.vehicles[0].boots
    hold(page, page.get_by_role("button", name="Reboot"))
    wait_until(page, lambda: world[0].simulation.vehicles[0].boots == boots + 1)
    # The answer comes once the vehicle has started.
    assert page.request.get(f"{world[1]}api/vehicles/1/parameters/SERVO3_REVERSED").ok


def test_outputs_receiver_and_battery(world, page) -> None:
    open_section(page, "Motors and outputs")
    parameters = world[0].simulation.vehicles[0].parameters
    page.get_by_role("checkbox", name="Output 3 is reversed").check()
    function = page.get_by_role("spinbutton", name="Function of output 5", exact=True)
    function.fill("10")
    function.press("Enter")
    wait_until(page, lambda: (parameters["SERVO3_REVERSED"], parameters["SERVO5_FUNCTION"]) == (1, 10))
    open_section(page, "Receiver")
    page.get_by_role("meter", name="Channel 1", exact=True).wait_for()
    playwright.expect(page.get_by_text("RC1_REVERSED")).to_be_visible()
    open_section(page, "Battery")
    playwright.expect(page.locator("dd").first).to_contain_text(" V")
    playwright.expect(page.get_by_text("BATT_MONITOR", exact=True)).to_be_visible()


def test_tuning_is_plotted_and_undone(world, page) -> None:
    parameters = world[0].simulation.vehicles[0].parameters
    before = parameters["ATC_RAT_PIT_P"]
    open_section(page, "Tuning")
    page.get_by_role("button", name="Pitch").click()
    playwright.expect(page.get_by_text(re.compile("Mean difference .* °/s, delay"))).to_be_visible()
    page.get_by_role("button", name="Angles in °").click()
    page.get_by_role("img", name="Set-point and response, Pitch").locator("canvas").wait_for()
    for value in ("0.2", "0.25"):
        field = page.get_by_label("ATC_RAT_PIT_P", exact=True)
        field.fill(value)
        field.press("Enter")
        playwright.expect(field).to_have_value(value)
        page.get_by_role("button", name="Undo ATC_RAT_PIT_P", exact=True).wait_for()
    page.get_by_role("button", name="Undo ATC_RAT_PIT_P", exact=True).click()
    playwright.expect(field).to_have_value("0.2")
    page.get_by_role("button", name="Pause the plot").click()
    page.get_by_role("button", name="Continue the plot").click()
    page.get_by_role("button", name=re.compile("Undo all")).click()
    playwright.expect(page.get_by_role("button", name=re.compile("Undo all"))).to_have_count(0)
    assert parameters["ATC_RAT_PIT_P"] == pytest.approx(before)


def test_px4_resets_parameters_only_if_asked_on_a_phone(world) -> None:
    simulator, url, new_page = world
    page = new_page(f"{url}#/setup", phone=True, dark=False)
    page.get_by_role("button", name="Choose a vehicle").click()
    page.get_by_role("option", name="Copter 2").click()
    open_section(page, "Airframe")
    reset = page.get_by_role("checkbox", name="Reset the parameters")
    again = page.get_by_role("button", name="Reset to this airframe")
    playwright.expect(again).to_be_enabled()
    reset.uncheck()
    playwright.expect(page.get_by_role("button", name="Change the airframe")).to_be_disabled()
    reset.check()
    page.get_by_role("combobox", name="Airframe").select_option(label="6001: hexacopter X")
    playwright.expect(page.get_by_text("Resets all other parameters.")).to_be_visible()
    reset.uncheck()
    playwright.expect(page.get_by_text("All other parameters stay as they are.")).to_be_visible()
    hold(page, page.get_by_role("button", name="Change the airframe"), 1800)
    playwright.expect(page.get_by_text("The airframe is now: hexacopter X.")).to_be_visible()
    assert simulator.simulation.vehicles[1].parameters["SYS_AUTOSTART"] == 6001


#: A parameter of each firmware with a value that is not its default, and the number of its copter.
LASTING = {"ardupilot": ("RTL_ALT", 2500, 1), "px4": ("RTL_RETURN_ALT", 45, 2)}
#: Seconds after which PX4 has written its file by itself.
SAVE_DELAY = 3


def choose_copter(page, number: int) -> None:
    page.get_by_role("button", name="Choose a vehicle").click()
    page.get_by_role("option", name=f"Copter {number}").click()


def find_parameter(page, name: str):
    """Return the field of a parameter in the list."""
    open_section(page, "Parameters")
    page.get_by_role("searchbox", name="Search names and descriptions").fill(name)
    return page.get_by_role("spinbutton", name=name, exact=True)


def set_parameter(page, name: str, value: int) -> None:
    """Set a parameter in the list, and wait until the vehicle holds the value."""
    field = find_parameter(page, name)
    field.fill(str(value))
    field.press("Enter")
    page.get_by_role("button", name=re.compile(f"Undo: set {name}")).wait_for()


@pytest.mark.parametrize("firmware", LASTING)
@pytest.mark.parametrize("phone", [False, True], ids=["desktop", "phone"])
@pytest.mark.flight_cases(2)
def test_a_parameter_outlasts_a_power_cycle(world, firmware, phone) -> None:
    simulator, url, new_page = world
    name, value, system = LASTING[firmware]
    value += phone
    copter = simulator.simulation.vehicles[system - 1]
    assert copter.parameters[name] != value
    page = new_page(f"{url}#/setup", phone=phone)
    choose_copter(page, system)
    set_parameter(page, name, value)
    due = simulator.simulation.now + SAVE_DELAY
    wait_until(page, lambda: simulator.simulation.now > due)
    boots = copter.boots
    simulator.call(copter.power_cycle)
    wait_until(page, lambda: copter.boots == boots + 1)
    assert copter.parameters[name] == value
    page.reload()
    choose_copter(page, system)
    playwright.expect(find_parameter(page, name)).to_have_value(str(value))
    page.context.close()


@pytest.mark.parametrize("firmware", ["betaflight", "inav"])
@pytest.mark.flight_cases(1)
def test_serial_ports_of_a_flight_controller_outlast_a_power_cycle(world, tmp_path, firmware) -> None:
    target, (_, _, new_page) = BackgroundFlightController(firmware), world
    with target, web_station(tmp_path, target.url) as url:
        page = new_page(f"{url}#/setup", phone=True)
        open_section(page, "Serial ports")
        page.get_by_label("Functions of UART2: GPS", exact=True).click()
        page.get_by_role("checkbox", name="GPS at UART2", exact=True).uncheck()
        page.get_by_role("checkbox", name="TELEMETRY MAVLINK at UART2", exact=True).check()
        page.get_by_role("combobox", name="Bits per second of UART2").select_option("57600")
        page.get_by_role("button", name="Set UART2").click()
        playwright.expect(page.get_by_role("button", name="Set UART2")).to_be_disabled()
        target.call(target.controller.power_cycle)
        port = target.call(lambda: target.controller.system.settings.get(SerialConfig).ports[2])
        assert "TELEMETRY_MAVLINK" in port.functions.name
        rates = BAUD_RATES if firmware == "betaflight" else INAV_BAUD_RATES
        assert rates[port.telemetry_baud] == 57600
        page.context.close()


#: Parameters that are in RAM alone until they are saved, with values that are not their defaults.
UNSAVED = {"betaflight": ("BF_PID_ROLL_P", 71), "inav": ("INAV_MAN_EXPO", 71)}


def restart(page, target: BackgroundFlightController) -> None:
    """Take away the power of a flight controller for a moment, and load the page again."""
    boots = target.controller.boots
    target.call(target.controller.power_cycle)
    wait_until(page, lambda: target.controller.boots > boots)
    page.reload()


@pytest.mark.parametrize("firmware", UNSAVED)
@pytest.mark.flight_cases(1)
def test_a_parameter_of_a_flight_controller_outlasts_a_power_cycle_once_saved(
    world, tmp_path, firmware
) -> None:
    target, (_, _, new_page) = BackgroundFlightController(firmware), world
    name, value = UNSAVED[firmware]
    with target, web_station(tmp_path, target.url) as url:
        page = new_page(f"{url}#/setup")
        open_section(page, "Tuning")
        for each in ("BF_PID_ROLL_P", "BF_PID_LEVEL_P", "BF_ROLL_RATE", "BF_RC_EXPO"):
            page.get_by_label(each, exact=True).wait_for()
        set_parameter(page, name, value)
        playwright.expect(page.get_by_text("1 parameter is not yet saved")).to_be_visible()
        restart(page, target)
        playwright.expect(find_parameter(page, name)).not_to_have_value(str(value))
        set_parameter(page, name, value)
        page.get_by_role("button", name="Save", exact=True).click()
        playwright.expect(page.get_by_text("not yet saved")).to_have_count(0)
        restart(page, target)
        playwright.expect(find_parameter(page, name)).to_have_value(str(value))
        page.context.close()
