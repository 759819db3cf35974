"""Betaflight and iNav over WebSerial in the page: a stand-in port of simulated flight controllers."""

from __future__ import annotations

import re
from contextlib import ExitStack

import pytest

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.modes import ModeRanges
from mavstack.msp.messages.osd import OsdConfig
from mavstack.msp.messages.pid import InavPid, Pid
from mavstack.msp.messages.rc import RcTuning
from mavstack.msp.messages.vtx import VtxConfig
from tests.recordings.controller import RecordedController
from tests.server.browsing import open_pages, web_station
from tests.server.web_serial import PORT
from tests.sim.msp.peer import Peer

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The URL of a station without vehicles, and a function for pages."""
    with ExitStack() as steps:
        url = steps.enter_context(web_station(tmp_path_factory.mktemp("station")))
        yield url, steps.enter_context(open_pages())


def connected(pages, peer: Peer | RecordedController, *, phone: bool = False):
    """Return a page that is connected to the flight controller of a peer."""
    url, new_page = pages
    page = new_page("about:blank", phone=phone, dark=not phone)

    def exchange(data: list[int]) -> list[int]:
        peer.run(0.05)
        return list(peer.send(bytes(data)))

    page.expose_function("exchange", exchange)
    page.add_init_script(PORT)
    page.goto(f"{url}#/msp")
    page.get_by_role("button", name="Choose a port and connect").click()
    playwright.expect(page.get_by_role("button", name="Disconnect")).to_be_visible()
    return page


def open_tab(page, name: str):
    page.get_by_role("tab", name=name, exact=True).click()


def save(page) -> None:
    playwright.expect(page.get_by_text("Not yet saved")).to_be_visible()
    page.get_by_role("button", name="Save", exact=True).click()
    playwright.expect(page.get_by_text("Not yet saved")).to_have_count(0)


#: The recorded program was built without it.
ABSENT = ("Video transmitter",)


def wait_until(page, holds) -> None:
    """Wait until a condition holds, while the page continues."""
    for _ in range(300):
        if holds():
            return
        page.wait_for_timeout(100)
    pytest.fail("the condition did not come about")


def test_betaflight_is_set_up_and_saved(pages) -> None:
    peer = Peer("betaflight")
    page = connected(pages, peer)
    playwright.expect(page.get_by_role("status").first).to_contain_text("Betaflight")
    playwright.expect(page.get_by_text(re.compile("RX_FAILSAFE|RXLOSS|ARM_SWITCH|RX"))).to_be_visible()
    open_tab(page, "Receiver")
    page.get_by_role("meter", name="Channel AUX 1").wait_for()
    open_tab(page, "PID")
    page.get_by_role("spinbutton", name="P of ROLL").fill("77")
    page.get_by_role("button", name="Set", exact=True).click()
    open_tab(page, "Rates")
    page.get_by_role("spinbutton", name="yaw rate", exact=True).fill("33")
    page.get_by_role("button", name="Set", exact=True).click()
    save(page)
    peer.controller.reboot()
    peer.run(3)
    assert peer.get(Pid).controllers[0].p == 77
    assert peer.get(RcTuning).yaw_rate == 33


def test_modes_display_and_transmitter_of_betaflight(pages) -> None:
    peer = Peer("betaflight")
    page = connected(pages, peer)
    open_tab(page, "Modes")
    page.get_by_role("button", name="Add a switch").click()
    index = page.get_by_role("combobox", name=re.compile("Mode of switch")).count()
    page.get_by_role("combobox", name=re.compile("Mode of switch")).last.select_option(label="HORIZON")
    page.get_by_role("combobox", name=re.compile("Channel of switch")).last.select_option(label="AUX 3")
    page.get_by_role("button", name=re.compile("Set switch")).last.click()
    playwright.expect(page.get_by_text("The flight controller has the values.")).to_be_visible()
    used = [each for each in peer.get(ModeRanges).ranges if each.is_used]
    assert len(used) == index
    assert any((each.mode, each.aux_channel) == (2, 2) for each in used)
    open_tab(page, "OSD")
    page.get_by_role("spinbutton", name="Column of ALTITUDE", exact=True).fill("7")
    page.get_by_role("checkbox", name="ALTITUDE is shown", exact=True).set_checked(True)
    page.get_by_role("button", name="Set ALTITUDE", exact=True).click()
    playwright.expect(page.get_by_role("button", name="Set ALTITUDE", exact=True)).to_be_disabled()
    assert (peer.get(OsdConfig).items or ())[15] & 31 == 7
    open_tab(page, "Video transmitter")
    page.get_by_role("spinbutton", name="channel", exact=True).fill("4")
    page.get_by_role("button", name="Set", exact=True).click()
    playwright.expect(page.get_by_role("button", name="Set", exact=True)).to_be_disabled()
    assert peer.get(VtxConfig).channel == 4


def test_ports_and_command_line_of_betaflight_on_a_phone(pages) -> None:
    peer = Peer("betaflight")
    page = connected(pages, peer, phone=True)
    open_tab(page, "Ports")
    gps = page.get_by_role("checkbox", name=re.compile("^GPS at port")).last
    gps.set_checked(not gps.is_checked())
    page.get_by_role("button", name="Set", exact=True).click()
    playwright.expect(page.get_by_text("The flight controller has the values.")).to_be_visible()
    open_tab(page, "CLI")
    line = page.get_by_role("textbox", name="Line")
    line.fill("get p_roll")
    page.get_by_role("button", name="Send").click()
    playwright.expect(page.get_by_role("log", name="Output")).to_contain_text("p_roll =")
    line.fill("exit")
    page.get_by_role("button", name="Send").click()
    playwright.expect(line).to_have_value("")
    peer.run(3)
    open_tab(page, "Status")
    playwright.expect(page.get_by_text("roll", exact=False).first).to_be_visible()


def test_inav_has_its_own_layouts(pages) -> None:
    peer = Peer("inav")
    page = connected(pages, peer)
    playwright.expect(page.get_by_role("status").first).to_contain_text("iNav")
    open_tab(page, "PID")
    page.get_by_role("spinbutton", name="F of PITCH").fill("61")
    page.get_by_role("button", name="Set", exact=True).click()
    playwright.expect(page.get_by_text("The flight controller has the values.")).to_be_visible()
    assert peer.get(InavPid).controllers[1].f == 61
    for name in ("Rates", "Failsafe", "OSD", "Modes", "Ports", "Receiver"):
        open_tab(page, name)
        playwright.expect(page.get_by_text("Reading …")).to_have_count(0)
    save(page)
    page.get_by_role("button", name="Disconnect").click()
    page.get_by_role("button", name="Choose a port and connect").wait_for()
    assert peer.request(MspCommand.MSP_API_VERSION) is not None


@pytest.mark.nightly
@pytest.mark.parametrize("phone", [False, True], ids=["desktop", "phone"])
def test_a_recorded_betaflight_is_shown(pages, phone: bool) -> None:
    controller = RecordedController()
    page = connected(pages, controller, phone=phone)
    playwright.expect(page.get_by_role("status").first).to_contain_text("2026.12.0")
    for name in ("Receiver", "Modes", "PID", "Rates", "Failsafe", "OSD", "Video transmitter", "Ports"):
        controller.requests.clear()
        open_tab(page, name)
        wait_until(page, lambda: bool(controller.requests))
        missing = ["The firmware of this board was built without this."] if name in ABSENT else []
        playwright.expect(page.get_by_role("alert")).to_have_text(missing)
        if name == "PID":
            playwright.expect(page.get_by_role("spinbutton", name="P of ROLL")).to_have_value("45")
