"""The fly view in Chromium: a copter is refused, armed, flown, steered and landed; buttons are held."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest

from tests.interop.station import (
    DESKTOP,
    MANUAL_CONTROL,
    PATIENT,
    PHONE,
    StationPage,
    StationServer,
    near,
    station_page,
    web_server,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]

SKY, GROUND, VEHICLE = (79, 148, 216), (138, 95, 53), (86, 180, 233)


def set_mode(shown: StationPage, name: str) -> None:
    shown.page.get_by_label("Flight mode").select_option(name)
    shown.button("Set").click()


def assert_drawn(shown: StationPage) -> None:
    """Assert that horizon and map have the pixels of their parts."""
    horizon = shown.pixels(shown.page.get_by_role("img", name="Flight display"))
    assert near(horizon, SKY) > 500
    assert near(horizon, GROUND) > 500
    assert near(shown.drawn(), VEHICLE, 30) > 40


def assert_steered(shown: StationPage) -> None:
    """Assert that sticks are sent while the space bar is held, and no longer."""
    shown.button("Sticks").click()
    shown.page.get_by_label("Steer with", exact=True).select_option("keys")
    shown.page.get_by_role("switch").check()
    shown.wait_for("Ready: hold the space bar")
    shown.page.evaluate("document.activeElement.blur()")  # keys in forms do not steer
    shown.sent.clear()
    shown.page.keyboard.down(" ")
    shown.page.keyboard.down("ArrowUp")
    shown.wait_for("Steering vehicle 1")
    shown.wait_until(lambda: shown.sent.count(MANUAL_CONTROL) > 20)
    shown.page.evaluate("window.dispatchEvent(new Event('blur'))")
    shown.wait_for("Ready: hold the space bar")
    stopped = shown.sent.count(MANUAL_CONTROL)
    shown.page.wait_for_timeout(300)
    assert shown.sent.count(MANUAL_CONTROL) == stopped
    shown.page.keyboard.up("ArrowUp")
    shown.page.keyboard.up(" ")
    shown.page.get_by_role("switch").uncheck()


def test_a_copter_is_flown(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, DESKTOP) as shown:
        shown.wait_for("Ready to arm")
        shown.button("Arm").click()
        shown.wait_for("Arm: hold to confirm")
        set_mode(shown, "RTL")
        shown.wait_until(lambda: server.state()["mode"] == "RTL")
        shown.hold("Arm")
        shown.wait_until(lambda: server.state()["armed"])  # arming leaves a mode in which it does not arm
        assert server.state()["mode"] == "GUIDED"
        shown.hold("Take off")
        shown.wait_until(lambda: server.state()["position"]["relative_altitude"] > 9)
        assert_drawn(shown)
        start = server.state()["position"]["latitude"]
        shown.page.mouse.click(720, 330)
        shown.hold("Go here")
        shown.wait_until(lambda: server.state()["position"]["latitude"] > start + 5e-5)
        assert_steered(shown)
        shown.hold("Land")
        shown.wait_until(lambda: not server.state()["armed"])


def test_the_view_fits_a_phone(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, PHONE, "light") as shown:
        shown.button("Arm").wait_for(timeout=PATIENT)
        assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
        for tab in ("Status", "Messages", "Sticks", "Video"):
            shown.page.get_by_role("tab", name=tab).click()
        assert_drawn(shown)


def let_go_by(shown: StationPage, name: str, change: Callable[[], object]) -> None:
    """Hold a guarded button and change something: the button must let go without acting."""
    shown.button(name).hover(timeout=PATIENT)
    shown.page.mouse.down()
    held = shown.page.locator(".guarded.held")
    held.wait_for(timeout=PATIENT)
    change()
    held.wait_for(state="detached", timeout=PATIENT)
    shown.page.wait_for_timeout(1000)
    shown.page.mouse.up()
    assert shown.page.get_by_text(": accepted").count() == 0
    assert shown.page.get_by_role("alert").count() == 0


def test_held_buttons_act_for_one_vehicle_only(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        page.goto(f"{server.url}?demo=3")
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        page.keyboard.press("]")
        shown.button("Choose a vehicle: VTOL 2").wait_for(timeout=PATIENT)
        page.get_by_placeholder("Speed").fill("3")
        let_go_by(shown, "Return", lambda: page.keyboard.press("]"))
        shown.button("Choose a vehicle: Plane 3").wait_for(timeout=PATIENT)
        assert page.get_by_placeholder("Speed").input_value() == ""
        let_go_by(shown, "Return", lambda: page.evaluate("window.dispatchEvent(new Event('blur'))"))
        shown.button("Return").hover()
        page.mouse.down(button="right")
        assert page.locator(".guarded.held").count() == 0
        page.mouse.up(button="right")
        shown.hold("Return")
        shown.wait_for("Return: accepted")


def test_motors_are_tested_after_a_confirmation_for_the_vehicle(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        page.goto(f"{server.url}?demo=2#/setup")
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        shown.button("Motors and outputs").click(timeout=PATIENT)
        propellers = page.get_by_label("propellers are off")
        propellers.check()
        let_go_by(shown, "Motor 1", lambda: propellers.evaluate("box => box.click()"))
        assert page.get_by_text("Motor 1 ran").count() == 0
        propellers.check()
        page.evaluate("document.activeElement.blur()")
        page.keyboard.press("]")
        shown.button("Choose a vehicle: VTOL 2").wait_for(timeout=PATIENT)
        page.keyboard.press("[")
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        assert not propellers.is_checked()
        assert shown.button("Motor 1").is_disabled()


@pytest.mark.nightly
def test_feet_are_typed_and_metres_are_sent(server: StationServer, browser: Any) -> None:
    with station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        page.evaluate("localStorage.setItem('mavstack.units', '\"imperial\"')")
        page.reload()
        sent: dict[str, Any] = {}

        def keep(request: Any) -> None:
            if request.method == "POST":
                sent[urlsplit(request.url).path.rsplit("/", 1)[1]] = json.loads(request.post_data or "{}")

        page.on("request", keep)
        shown.button("Arm").wait_for(timeout=PATIENT)
        set_mode(shown, "GUIDED")
        shown.wait_until(lambda: server.state()["mode"] == "GUIDED")
        shown.hold("Arm")
        shown.wait_until(lambda: server.state()["armed"])
        shown.hold("Take off")
        shown.wait_until(lambda: server.state()["in_air"])
        page.get_by_placeholder("Altitude").first.fill("82")
        page.keyboard.press("Enter")
        page.mouse.click(720, 330)
        page.get_by_role("dialog", name="Target").get_by_label("Altitude").fill("98.4")
        shown.hold("Go here")
        shown.wait_until(lambda: "goto" in sent)
        heights = [sent[action]["altitude"] for action in ("takeoff", "altitude", "goto")]
        assert heights == pytest.approx([33 * 0.3048, 82 * 0.3048, 98.4 * 0.3048])
        shown.hold("Land")
        shown.wait_until(lambda: not server.state()["armed"])


GAMEPAD = """(() => {
  const buttons = Array.from({ length: 16 }, () => ({ pressed: false, value: 0 }));
  window.pad = { id: 'Test pad', index: 0, connected: true, axes: [0, 0, 0, 0], buttons };
  navigator.getGamepads = () => [window.pad];
})()"""


def test_a_gamepad_steers_only_while_its_button_is_held(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        page.add_init_script(GAMEPAD)
        page.goto(f"{server.url}?demo=1")
        shown.button("Sticks").click(timeout=PATIENT)
        page.evaluate("pad.buttons[4].pressed = true")
        page.get_by_role("switch").check()
        shown.wait_for("Let go of button 5 first")
        for stop, reason in (
            ("pad.connected = false", "No controller"),
            ("window.dispatchEvent(new Event('blur'))", "Stopped: the page is hidden"),
        ):
            page.evaluate("pad.buttons[4].pressed = false")
            shown.wait_for("Ready: hold button 5")
            page.evaluate("pad.buttons[4].pressed = true")
            shown.wait_for("Steering vehicle 1")
            page.evaluate(stop)
            shown.wait_for(reason)
            page.evaluate("pad.connected = true")
            page.wait_for_timeout(300)
            assert page.get_by_text("Steering vehicle 1").count() == 0


KEEP_SHADERS = """(() => {
  window.shaders = [];
  const { prototype } = WebGL2RenderingContext;
  const original = prototype.shaderSource;
  prototype.shaderSource = function (shader, source) {
    window.shaders.push(source);
    return original.call(this, shader, source);
  };
})()"""


def test_the_map_computes_no_sky(browser: Any, tmp_path: Path) -> None:
    """A map that is never tilted shows no sky, which costs most of a frame without a graphics processor."""
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        page = shown.page
        page.add_init_script(KEEP_SHADERS)
        page.goto(f"{server.url}?demo=3")
        shown.wait_until(lambda: page.evaluate("window.shaders.some((each) => each.includes('v_width2'))"))
        assert not page.evaluate("window.shaders.some((each) => each.includes('u_sky_color'))")
