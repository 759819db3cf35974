"""Sticks in Chromium: MANUAL_CONTROL on the wire, 50 times a second of the page's clock, by vehicle type."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.sim import BackgroundSimulator
from tests.interop.station import DESKTOP, PATIENT, StationPage, station_page, web_server
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

PAD = """(() => {
  const buttons = Array.from({ length: 16 }, () => ({ pressed: false, value: 0 }))
  window.pad = { id: 'Test pad', index: 0, connected: true, axes: [0.4, -0.6, -0.8, 1], buttons }
  navigator.getGamepads = () => [window.pad]
})()"""
LINEAR = """localStorage.setItem('mavstack.fly.manual',
  JSON.stringify({ mode: 2, deadZone: 0, expo: 0, deadMan: 4, inverted: [] }))"""
HIDE = """Object.defineProperty(document, 'hidden', { configurable: true, get: () => true })
document.dispatchEvent(new Event('visibilitychange'))"""
NEXT_VEHICLE = "document.body.dispatchEvent(new KeyboardEvent('keydown', { key: ']', bubbles: true }))"
#: Type of each vehicle, and x, y, z, r and buttons of its messages; the second button is held too.
VEHICLES = {
    "copter": (-1000, -800, 800, 400, 0),
    "rover": (-1000, -800, 600, 400, 0),
    "sub": (-1000, -800, 800, 400, 2),
}
#: The throttle that a vehicle keeps when the button is released.
NEUTRAL = {"copter": 500, "rover": 0, "sub": 500}


@dataclass
class Sticks:
    """The page with the sticks of three vehicles, the messages that it sent, the vehicles that it heard."""

    shown: StationPage
    sent: list[common.ManualControl] = field(default_factory=list)
    heard: set[int] = field(default_factory=set)

    def wait_for_heartbeats(self) -> None:
        """Wait for a heartbeat of each vehicle, which is alive in the next five seconds of the page."""
        self.heard.clear()
        self.shown.wait_until(lambda: len(self.heard) == len(VEHICLES))


def listen(sticks: Sticks) -> None:
    """Keep the messages of the page's WebSocket."""
    dialect = mavstack.Dialect.load("ardupilotmega")
    from_page, from_vehicles = mavstack.Parser(dialect), mavstack.Parser(dialect)

    def keep_sent(payload: bytes | str) -> None:
        if isinstance(payload, bytes):
            messages = [packet.message for packet in from_page.feed(payload)]
            sticks.sent.extend(each for each in messages if isinstance(each, common.ManualControl))

    def keep_heard(payload: bytes | str) -> None:
        if isinstance(payload, bytes):
            packets = from_vehicles.feed(payload)
            sticks.heard.update(each.system for each in packets if isinstance(each.message, common.Heartbeat))

    def keep(socket: Any) -> None:
        socket.on("framesent", keep_sent)
        socket.on("framereceived", keep_heard)

    sticks.shown.page.on("websocket", keep)


@contextmanager
def sticks_page(browser: Any, folder: Path) -> Iterator[Sticks]:
    """Show the sticks of three vehicles, steered by a gamepad."""
    simulator = BackgroundSimulator("copter")
    for vehicle_type in ("rover", "sub"):
        simulator.simulation.add(vehicle_type)
    make_ready(simulator.simulation)
    with (
        simulator,
        web_server(folder, f"udpout://127.0.0.1:{simulator.port}") as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        page = shown.page
        sticks = Sticks(shown)
        listen(sticks)
        page.add_init_script(PAD + ";" + LINEAR)
        page.clock.install()
        page.reload()
        shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
        shown.wait_until(lambda: page.locator(".cards .card").count() == len(VEHICLES))
        shown.button("Sticks").click(timeout=PATIENT)
        page.get_by_role("switch").check()
        yield sticks


def hold(shown: StationPage, pressed: bool) -> None:
    shown.page.evaluate(f"pad.buttons[4].pressed = {str(pressed).lower()}")


def pause(shown: StationPage) -> None:
    """Stop the clock of the page, so that only `run_for` lets time pass."""
    shown.page.clock.pause_at(shown.page.evaluate("Date.now()") / 1000 + 0.2)


def fields(message: common.ManualControl) -> tuple[int, ...]:
    return (message.x, message.y, message.z, message.r, message.buttons)


def test_each_vehicle_gets_its_own_sticks_fifty_times_a_second(browser: Any, tmp_path: Path) -> None:
    with sticks_page(browser, tmp_path) as sticks:
        shown, sent, page = sticks.shown, sticks.sent, sticks.shown.page
        page.evaluate("pad.buttons[1].pressed = true")
        for system, (vehicle_type, expected) in enumerate(VEHICLES.items(), 1):
            # The clock of the page runs ahead of the vehicles.
            sticks.wait_for_heartbeats()
            shown.wait_for("Ready: hold button 5")
            pause(shown)
            hold(shown, pressed=True)
            sent.clear()
            page.clock.run_for(2000)
            shown.wait_until(lambda: len(sent) >= 100)
            assert len(sent) == 100
            assert {(each.target, fields(each)) for each in sent} == {(system, expected)}
            hold(shown, pressed=False)
            sent.clear()
            page.clock.run_for(1000)
            shown.wait_until(lambda: len(sent) >= 3)
            neutral = (0, 0, NEUTRAL[vehicle_type], 0, 0)
            assert [fields(each) for each in sent] == [neutral] * 3
            page.clock.resume()
            page.evaluate(NEXT_VEHICLE)


#: Scripts that end the steering, scripts that undo that, and the text that is shown; the button is held.
STOPS = (
    ("pad.connected = false", "pad.connected = true", "No controller"),
    ("navigator.getGamepads = () => []", "navigator.getGamepads = () => [pad]", "No controller"),
    ("window.dispatchEvent(new Event('blur'))", "0", "Stopped: the page is hidden"),
    (HIDE, "delete document.hidden", "Stopped: the page is hidden"),
    (NEXT_VEHICLE, "0", "Stopped: another vehicle"),
)


def test_steering_stops_with_centred_sticks_and_shows_why(browser: Any, tmp_path: Path) -> None:
    with sticks_page(browser, tmp_path) as sticks:
        shown, sent, page = sticks.shown, sticks.sent, sticks.shown.page
        system = 1
        for stop, undo, text in STOPS:
            hold(shown, pressed=False)
            shown.wait_for("Ready: hold button 5")
            hold(shown, pressed=True)
            shown.wait_for(f"Steering vehicle {system}")
            page.evaluate(stop)
            shown.wait_for(text)
            shown.wait_until(lambda: bool(sent) and sent[-1].z == 500)
            assert [(each.target, *fields(each)[:4]) for each in sent[-3:]] == [(system, 0, 0, 500, 0)] * 3
            sent.clear()
            page.evaluate(undo)
            page.clock.run_for(1000)
            assert page.get_by_text("Steering vehicle").count() == 0
            assert sent == []
        shown.button("Choose a vehicle: Rover 2").wait_for(timeout=PATIENT)


def test_another_view_ends_the_steering(browser: Any, tmp_path: Path) -> None:
    with sticks_page(browser, tmp_path) as sticks:
        shown, sent = sticks.shown, sticks.sent
        shown.wait_for("Ready: hold button 5")
        hold(shown, pressed=True)
        shown.wait_for("Steering vehicle 1")
        shown.page.evaluate("location.hash = '#/plan'")
        shown.page.get_by_text("Steering vehicle").wait_for(state="detached", timeout=PATIENT)
        shown.wait_until(lambda: [fields(each)[2] for each in sent[-3:]] == [500] * 3)
        sent.clear()
        shown.page.evaluate("location.hash = '#/fly'")
        shown.button("Sticks").click(timeout=PATIENT)
        assert not shown.page.get_by_role("switch").is_checked()
        assert sent == []


def test_a_gamepad_is_calibrated_and_its_buttons_act(browser: Any, tmp_path: Path) -> None:
    with sticks_page(browser, tmp_path) as sticks:
        shown, sent, page = sticks.shown, sticks.sent, sticks.shown.page
        shown.wait_for("Ready: hold button 5")
        page.get_by_text("Settings of the controller").click()
        page.evaluate("pad.axes = [0, 0, 0.1, 0]")
        page.clock.run_for(200)
        shown.button("Calibrate").click()
        for axes in ("[0, 0, -0.5, 0]", "[0, 0, 0.6, 0]", "[0, 0, 0.1, 0]"):
            page.evaluate(f"pad.axes = {axes}")
            page.clock.run_for(200)
        shown.button("Done").click()
        shown.wait_for("Axes that are calibrated: 3")
        page.evaluate("pad.axes = [0, 0, 0.6, 0]")
        hold(shown, pressed=True)
        shown.wait_until(lambda: bool(sent) and sent[-1].y == 1000)
        hold(shown, pressed=False)
        page.get_by_role("combobox", name="Button 1", exact=True).select_option("arm")
        sticks.wait_for_heartbeats()
        page.clock.run_for(500)
        page.evaluate("pad.buttons[0].pressed = true")
        page.clock.run_for(1500)
        shown.wait_for("Armed")
        page.evaluate("pad.buttons[0].pressed = false")
        kept = page.evaluate("JSON.parse(localStorage.getItem('mavstack.fly.pads'))['Test pad']")
        assert (kept["actions"], list(kept["ranges"])) == ({"0": "arm"}, ["2"])
