"""`mav firmware` against a simulated board, in virtual time."""

from __future__ import annotations

import asyncio
import json

import pytest

from mavstack.cli.firmware import command
from mavstack.flashing import FlashingRefused, autopilot_board, backup, board_flasher, bootloader_port
from mavstack.flashing.json_container import make_container
from mavstack.flashing.ports import PortInfo
from mavstack.flashing.simulated_board import SimulatedBoard
from mavstack.flashing.simulated_bootloader import PX4_BOARD
from mavstack.flashing.simulated_port import SimulatedPort
from mavstack.links import MemoryNetwork
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

PORT = "/dev/ttyACM7"
PORTS = [PortInfo("/dev/ttyACM7", "PX4 FMUv5", "", "26ac:0032"), PortInfo("/dev/ttyS0")]


@pytest.fixture
def board(monkeypatch, tmp_path):
    """A board that every command reaches, whatever port it names."""
    board = SimulatedBoard("px4", PX4_BOARD)
    network = MemoryNetwork()

    def run(work):
        async def beside():
            nonlocal network
            network = MemoryNetwork()
            async with SimulatedPort(board, network.link()):
                return await work

        return run_virtually(beside())

    monkeypatch.setattr(asyncio, "run", run)
    monkeypatch.setattr(board_flasher, "_devices", frozenset)
    monkeypatch.setattr(bootloader_port, "open_link", lambda url: network.link())
    monkeypatch.setattr(autopilot_board, "connect", lambda url: connect(network.link()))
    monkeypatch.setattr(backup, "state_directory", lambda: tmp_path)
    monkeypatch.setattr(command, "list_ports", lambda: PORTS)
    monkeypatch.setattr(command, "has_modem_manager", lambda: False)
    return board


@pytest.fixture
def files(tmp_path):
    image = b"\x00\x10\x00\x20" + bytes(3000)
    for name, board_id in (("right.px4", 50), ("wrong.px4", 9)):
        (tmp_path / name).write_bytes(make_container(image, board_id, image_maxsize=2_064_384))
    return tmp_path


def test_info_of_a_file(mav, files) -> None:
    result = mav("firmware", "info", str(files / "right.px4"))
    assert result.out.splitlines() == [
        "kind     px4", "name     test", "version  1.0", "board    50", "size     3.0 kB of 2.1 MB",
    ]  # fmt: skip
    found = json.loads(mav("firmware", "info", str(files / "wrong.px4"), "--json").out)
    assert (found["board"], found["size"], found["signed"]) == (9, 3004, False)


def test_info_of_a_board(mav, board) -> None:
    result = mav("firmware", "info", "--port", PORT)
    assert result.out.startswith("board          board 50, Pixhawk 4 (FMUv5)\n")
    assert json.loads(mav("firmware", "info", "--port", PORT, "--json").out)["flash_size"] == 2_064_384


def test_info_of_a_board_that_is_not_in_its_bootloader(mav, board, files) -> None:
    mav("firmware", "flash", str(files / "right.px4"))
    result = mav("firmware", "info", "--port", PORT)
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith("mav firmware: /dev/ttyACM7: no bootloader answers; unplug the board")


def test_list(mav, board) -> None:
    assert mav("firmware", "list").out.splitlines()[0] == "/dev/ttyACM7  26ac:0032  PX4 FMUv5"
    assert [each["device"] for each in json.loads(mav("firmware", "list", "--json").out)] == [
        "/dev/ttyACM7",
        "/dev/ttyS0",
    ]


def test_flash(mav, board, files) -> None:
    result = mav("firmware", "flash", str(files / "right.px4"), "--port", PORT, "--dry-run")
    assert result.out == "board 50, Pixhawk 4 (FMUv5): the firmware fits; nothing was written\n"
    assert board.in_bootloader
    result = mav("firmware", "flash", str(files / "right.px4"), "--port", PORT)
    assert (result.out, result.err) == ("board 50, Pixhawk 4 (FMUv5): 3.0 kB written and verified\n", "")
    assert not board.in_bootloader
    result = mav("firmware", "flash", str(files / "right.px4"), "--json")
    found = json.loads(result.out)
    assert (found["port"], found["written"], found["parameters"]["failed"]) == (PORT, 3004, [])


def test_both_radios_are_checked_before_the_first_is_erased(mav, files, monkeypatch) -> None:
    calls = []

    async def flash(firmware, port, options):
        calls.append((port, options.dry_run))
        if port.endswith("1"):
            raise FlashingRefused(f"flashing {port} failed: the firmware is for another radio")

    monkeypatch.setattr(command, "flash_firmware", flash)
    monkeypatch.setattr(command, "has_modem_manager", lambda: False)
    ports = ("--port", "/dev/ttyUSB0", "--port", "/dev/ttyUSB1")
    result = mav("firmware", "flash", str(files / "right.px4"), *ports)
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert calls == [("/dev/ttyUSB0", True), ("/dev/ttyUSB1", True)]


def test_refusals_are_one_line(mav, board, files, monkeypatch) -> None:
    result = mav("firmware", "flash", str(files / "wrong.px4"), "--port", PORT)
    assert (result.code, result.out, result.err.count("\n")) == (1, "", 1)
    assert "the firmware is for board 9, Pixhawk 1 (FMUv2, FMUv3); get the file for board 50" in result.err
    (files / "cut.px4").write_bytes((files / "right.px4").read_bytes()[:200])
    result = mav("firmware", "flash", str(files / "cut.px4"), "--port", PORT)
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert "the file may be cut off" in result.err
    monkeypatch.setattr(command, "list_ports", list)
    result = mav("firmware", "flash", str(files / "right.px4"))
    assert (result.code, result.err) == (
        1,
        "mav firmware: no known board is plugged in; name one by --port\n",
    )


def test_texts_of_files_and_boards_do_not_control_the_terminal(mav, board, tmp_path, monkeypatch) -> None:
    path = tmp_path / "bad.px4"
    path.write_bytes(make_container(b"1234", 9, summary="\x1b[2Jboard", version="1\x07"))
    result = mav("firmware", "info", str(path))
    assert "board" in result.out
    assert not {"\x1b", "\x07"} & set(result.out)
    monkeypatch.setattr(command, "list_ports", lambda: [PortInfo("/dev/ttyS0", "", "\x1b]0;x\x07thing")])
    result = mav("firmware", "list")
    assert "thing" in result.out
    assert not {"\x1b", "\x07"} & set(result.out)


def test_wrong_usage(mav, files) -> None:
    for words in ([], [str(files / "right.px4"), "--port", PORT]):
        assert mav("firmware", "info", *words).code == 2
