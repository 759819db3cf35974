"""Flashing in the page: by WebSerial, with a stand-in port of simulated boards, and by the station."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from dataclasses import replace
from random import Random
from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.flashing.background_board import BackgroundBoard
from mavstack.flashing.bootloader_client import Op
from mavstack.flashing.firmware_file import FirmwareKind
from mavstack.flashing.json_container import make_container
from mavstack.flashing.simulated_bootloader import ARDUPILOT_BOARD, PX4_BOARD, SimulatedBootloader
from mavstack.wire import Encoder, Parser
from tests.server.browsing import hold, open_pages, web_station
from tests.server.web_serial import PORT

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")

IMAGE = b"\x00\x10\x00\x20" + Random(5).randbytes(9000)
PX4 = replace(PX4_BOARD, flash_size=32_768)
CUBE = replace(ARDUPILOT_BOARD, flash_size=32_768, external_size=8192)


class Board:
    """A board at the port, in its bootloader: it counts requests, and may lose its power."""

    def __init__(self, bootloader: SimulatedBootloader) -> None:
        self.bootloader = bootloader
        self.requests: list[Op] = []
        self.cut_after: int | None = None
        self.is_stalled = False
        self.now = 0.0
        bootloader.listeners.append(self.requests.append)

    def exchange(self, data: list[int]) -> list[int] | None:
        self.now += 0.02
        if self.is_stalled:
            return []
        self.bootloader.receive(bytes(data), self.now)
        if self.cut_after is not None and len(self.requests) >= self.cut_after:
            self.cut_after = None
            self.bootloader.power_cycle()
            return None
        return list(self.bootloader.output())


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The URL of a station without vehicles, and a function for pages."""
    with ExitStack() as steps:
        url = steps.enter_context(web_station(tmp_path_factory.mktemp("station")))
        yield url, steps.enter_context(open_pages())


def opened(pages: Any, exchange: Any, *, phone: bool = False) -> Any:
    """Return the page for firmware with this line at its port."""
    url, new_page = pages
    page = new_page("about:blank", phone=phone, dark=not phone)
    page.expose_function("exchange", exchange)
    page.add_init_script(PORT)
    page.goto(f"{url}#/setup")
    return page


def choose_file(page: Any, data: bytes, name: str = "board.px4") -> None:
    file = {"name": name, "mimeType": "application/json", "buffer": data}
    page.get_by_label("File for the board").set_input_files(file)


def flash(page: Any) -> None:
    hold(page, page.get_by_role("button", name="Flash the board at this computer"), 2300)


@pytest.mark.parametrize("phone", [False, True], ids=["desktop", "phone"])
def test_a_board_is_flashed(pages: Any, phone: bool) -> None:
    board = Board(SimulatedBootloader(PX4))
    page = opened(pages, board.exchange, phone=phone)
    choose_file(page, make_container(IMAGE, 50))
    playwright.expect(page.get_by_text("board 50, Pixhawk 4 (FMUv5)").first).to_be_visible()
    page.get_by_role("button", name="Choose the port of the board").click()
    playwright.expect(page.get_by_text("Bootloader (revision 5) of board 50")).to_be_visible()
    assert Op.CHIP_ERASE not in board.requests
    flash(page)
    playwright.expect(page.get_by_text("The firmware is on")).to_be_visible()
    assert bytes(board.bootloader.internal.content[: len(IMAGE)]) == IMAGE
    assert board.bootloader.started


def test_external_flash_is_written_first(pages: Any) -> None:
    board = Board(SimulatedBootloader(CUBE))
    page = opened(pages, board.exchange)
    external = Random(6).randbytes(5000)
    choose_file(page, make_container(IMAGE, 140, FirmwareKind.APJ, external=external), "cube.apj")
    page.get_by_role("button", name="Choose the port of the board").click()
    playwright.expect(page.get_by_text("Bootloader (revision 5) of board 140")).to_be_visible()
    flash(page)
    playwright.expect(page.get_by_text("The firmware is on")).to_be_visible()
    assert bytes(board.bootloader.external.content[:5000]) == external
    assert board.requests.index(Op.EXTF_ERASE) < board.requests.index(Op.CHIP_ERASE)


def test_a_file_that_does_not_fit_is_refused_before_the_first_erase(pages: Any) -> None:
    board = Board(SimulatedBootloader(PX4))
    page = opened(pages, board.exchange)
    choose_file(page, b"{")
    playwright.expect(page.get_by_role("alert")).to_contain_text("reading board.px4 failed: not JSON")
    page.get_by_role("button", name="Choose the port of the board").click()
    button = page.get_by_role("button", name="Flash the board at this computer")
    for data, reason in (
        (make_container(IMAGE, 9), "the firmware is for board 9"),
        (make_container(Random(7).randbytes(40_000), 50), "the firmware has 40000 bytes, the board 32768"),
        (make_container(IMAGE, 50, external=b"abcd"), "4 bytes of external flash, the board 0"),
    ):
        choose_file(page, data)
        playwright.expect(page.get_by_role("alert")).to_contain_text(reason)
        playwright.expect(button).to_be_disabled()
    assert Op.CHIP_ERASE not in board.requests


def test_a_board_that_lost_its_power_is_flashed_again(pages: Any) -> None:
    board = Board(SimulatedBootloader(PX4))
    page = opened(pages, board.exchange)
    choose_file(page, make_container(IMAGE, 50))
    page.get_by_role("button", name="Choose the port of the board").click()
    playwright.expect(page.get_by_text("Bootloader (revision 5)")).to_be_visible()
    board.cut_after = len(board.requests) + 20
    flash(page)
    playwright.expect(page.get_by_role("alert")).to_contain_text("the board stays in its bootloader")
    assert not board.bootloader.has_firmware
    page.get_by_role("button", name="Choose the port of the board").click()
    playwright.expect(page.get_by_text("Bootloader (revision 5)")).to_be_visible()
    flash(page)
    playwright.expect(page.get_by_text("The firmware is on")).to_be_visible()
    assert board.bootloader.started


def test_the_browser_asks_before_it_closes_a_page_that_writes(pages: Any) -> None:
    board = Board(SimulatedBootloader(PX4))
    page = opened(pages, board.exchange)
    choose_file(page, make_container(IMAGE, 50))
    page.get_by_role("button", name="Choose the port of the board").click()
    playwright.expect(page.get_by_text("Bootloader (revision 5)")).to_be_visible()
    closes = "() => dispatchEvent(new Event('beforeunload', { cancelable: true }))"
    assert page.evaluate(closes)
    board.is_stalled = True
    flash(page)
    playwright.expect(page.get_by_text("Flashing: erase")).to_be_visible()
    assert not page.evaluate(closes)
    board.is_stalled, board.cut_after = False, 0
    playwright.expect(page.get_by_role("alert")).to_contain_text("the board stays in its bootloader")
    assert page.evaluate(closes)


def test_a_running_autopilot_is_asked_to_start_its_bootloader_unless_it_is_armed(pages: Any) -> None:
    encoder, parser = Encoder(system=7, component=1), Parser(common)
    gimbals = Encoder(system=7, component=154)
    commands: list[common.CommandLong] = []
    mode = common.MavModeFlag.SAFETY_ARMED
    board: Board | None = None

    def exchange(data: list[int]) -> list[int] | None:
        if board is not None:
            return board.exchange(data)
        messages = (packet.message for packet in parser.feed(bytes(data)))
        asked = [each for each in messages if isinstance(each, common.CommandLong)]
        commands.extend(asked)
        acks = [common.CommandAck(command=each.command, result=common.MavResult.ACCEPTED) for each in asked]
        heartbeat = common.Heartbeat(
            type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4, base_mode=mode
        )
        gimbal = common.Heartbeat(type=common.MavType.GIMBAL, autopilot=common.MavAutopilot.INVALID)
        return list(gimbals.encode(gimbal) + b"".join(map(encoder.encode, [*acks, heartbeat])))

    page = opened(pages, exchange)
    choose_file(page, make_container(IMAGE, 50))
    page.get_by_role("button", name="Choose the port of the board").click()
    playwright.expect(page.get_by_text("The autopilot of vehicle 7 runs at this port.")).to_be_visible()
    start = page.get_by_role("button", name="Start the bootloader")
    hold(page, start)
    playwright.expect(page.get_by_role("alert")).to_contain_text("it is armed; disarm it first")
    assert commands == []
    mode = common.MavModeFlag(0)
    hold(page, start)
    playwright.expect(page.get_by_text("The autopilot starts its bootloader.")).to_be_visible()
    assert [(each.command, each.param1, each.target_system) for each in commands] == [
        (common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN, 3, 7)
    ]
    board = Board(SimulatedBootloader(PX4))
    page.get_by_role("button", name="Choose the port of the board").click()
    playwright.expect(page.get_by_text("Bootloader (revision 5)")).to_be_visible()
    flash(page)
    playwright.expect(page.get_by_text("The firmware is on")).to_be_visible()
    assert board.bootloader.started


@pytest.mark.nightly
@pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo terminals")
def test_a_board_at_a_port_of_the_station_is_checked_and_flashed(pages: Any) -> None:
    url, new_page = pages
    page = new_page(f"{url}#/setup", phone=True)
    with BackgroundBoard("px4") as board:
        page.get_by_label("Port of the station").fill(board.port)
        file = {"name": "board.px4", "mimeType": "", "buffer": make_container(IMAGE, 50)}
        page.get_by_label("File of the firmware").set_input_files(file)
        page.get_by_role("button", name="Check only").click()
        playwright.expect(page.get_by_text("nothing was changed")).to_be_visible()
        assert not board.has_firmware
        hold(page, page.get_by_role("button", name="Flash", exact=True), 2300)
        playwright.expect(page.get_by_text("The firmware is on the board")).to_be_visible()
        assert board.has_firmware
