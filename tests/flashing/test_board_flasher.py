"""The whole procedure over a port in virtual time: backup, bootloader, checks, writing, restoring."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from mavstack.flashing import (
    FlashingError,
    FlashingRefused,
    FlashOptions,
    Phase,
    autopilot_board,
    board_flasher,
    bootloader_port,
    flash_firmware,
    parse_firmware,
)
from mavstack.flashing.firmware_file import FirmwareKind
from mavstack.flashing.json_container import make_container
from mavstack.flashing.simulated_board import SimulatedBoard
from mavstack.flashing.simulated_bootloader import ARDUPILOT_BOARD, PX4_BOARD
from mavstack.flashing.simulated_port import SimulatedPort
from mavstack.links import MemoryNetwork
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

IMAGE = b"\x00\x10\x00\x20" + bytes(range(256)) * 20
SMALL = replace(PX4_BOARD, flash_size=16384)
PORT = "/dev/ttyBOARD"


@pytest.fixture
def bench(monkeypatch, tmp_path):
    """Run a flasher at the port of a simulated board."""
    monkeypatch.setattr(board_flasher, "_devices", frozenset)

    @asynccontextmanager
    async def plugged_in(board):
        network = MemoryNetwork()
        monkeypatch.setattr(bootloader_port, "open_link", lambda url: network.link())
        monkeypatch.setattr(autopilot_board, "connect", lambda url: connect(network.link()))
        async with SimulatedPort(board, network.link()):
            yield

    def run(board, firmware, **options):
        async def work():
            async with plugged_in(board):
                return await flash_firmware(firmware, PORT, FlashOptions(backup_folder=tmp_path, **options))

        return run_virtually(work())

    return run


def firmware(board_id=50, image=IMAGE, kind=FirmwareKind.PX4, **fields):
    return parse_firmware(make_container(image, board_id, kind, **fields))


def px4(**options) -> SimulatedBoard:
    return SimulatedBoard("px4", SMALL, **options)


def holds(board, image=IMAGE) -> bool:
    return bytes(board.bootloader.internal.content[: len(image)]) == image


def test_a_board_without_firmware(bench) -> None:
    board = px4()
    result = bench(board, firmware())
    assert (result.written, result.attempts, result.restored) == (len(IMAGE), 1, None)
    assert "board 50" in result.board
    assert holds(board)
    assert not board.in_bootloader


def test_a_running_autopilot_keeps_its_parameters(bench, tmp_path) -> None:
    board = px4(has_firmware=True, forgets=True)
    board.vehicle.parameters.set("RTL_RETURN_ALT", 77.0)
    board.vehicle.parameters.set("CAL_ACC0_ID", 1234)
    phases = []
    result = bench(board, firmware(), report=lambda phase, *_: phases.append(phase))
    assert holds(board)
    assert board.vehicle.parameters["RTL_RETURN_ALT"] == 77
    assert board.vehicle.parameters["CAL_ACC0_ID"] == 1234
    assert result.restored.set >= 2
    assert result.restored.failed == ()
    assert [path.name for path in tmp_path.iterdir()] == ["dev-ttyBOARD-restored.params"]
    assert list(dict.fromkeys(phases)) == [
        Phase.CONNECT, Phase.BACKUP, Phase.BOOTLOADER, Phase.CHECK, Phase.ERASE, Phase.PROGRAM, Phase.VERIFY,
        Phase.REBOOT, Phase.RESTORE, Phase.DONE,
    ]  # fmt: skip


def test_no_backup(bench, tmp_path) -> None:
    board = px4(has_firmware=True, forgets=True)
    board.vehicle.parameters.set("RTL_RETURN_ALT", 77.0)
    result = bench(board, firmware(), keep_parameters=False)
    assert result.restored is None
    assert board.vehicle.parameters["RTL_RETURN_ALT"] != 77
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("running", [False, True])
def test_a_dry_run_writes_nothing(bench, running) -> None:
    board = px4(has_firmware=running)
    before = bytes(board.bootloader.internal.content)
    result = bench(board, firmware(), dry_run=True)
    assert result.written == 0
    assert bool(result.notes) is running
    assert bytes(board.bootloader.internal.content) == before
    assert board.in_bootloader is not running


@pytest.mark.parametrize("dry_run", [False, True])
@pytest.mark.parametrize("running", [False, True])
def test_the_firmware_of_another_board_is_refused(bench, running, dry_run) -> None:
    if dry_run and running:
        pytest.skip("a running PX4 does not tell its board")
    board = px4(has_firmware=running)
    before = bytes(board.bootloader.internal.content)
    with pytest.raises(FlashingRefused, match=r"flashing board 50, Pixhawk 4 \(FMUv5\) failed: the firmware"):
        bench(board, firmware(9), dry_run=dry_run)
    assert bytes(board.bootloader.internal.content) == before


def test_an_armed_vehicle_is_not_flashed(bench) -> None:
    board = px4(has_firmware=True)
    assert not board.vehicle.autopilot.arm(force=True)
    with pytest.raises(FlashingRefused, match="flashing PX4 vehicle 1 failed: it is armed; disarm it first"):
        bench(board, firmware())
    assert not board.in_bootloader


def test_ardupilot_with_external_flash(bench) -> None:
    board = SimulatedBoard(
        "ardupilot", replace(ARDUPILOT_BOARD, flash_size=16384, external_size=65536), has_firmware=True
    )
    file = firmware(140, kind=FirmwareKind.APJ, external=bytes(40_000))
    result = bench(board, file)
    assert holds(board)
    assert result.restored is not None


def lose_power_after(board, op: int, count: int, times: int = 1) -> None:
    """Cut the power when the board has carried out so many requests of a kind."""
    done = cuts = 0

    def carried_out(each):
        nonlocal done, cuts
        done += each == op
        if done >= count and cuts < times:
            done, cuts = 0, cuts + 1
            loop = asyncio.get_running_loop()
            loop.call_soon(lambda: board.power_cycle(loop.time()))

    board.bootloader.listeners.append(carried_out)


def test_a_board_that_loses_its_power_is_written_again(bench) -> None:
    board = px4()
    lose_power_after(board, 0x27, 7)
    result = bench(board, firmware())
    assert result.attempts == 2
    assert holds(board)
    assert not board.in_bootloader


def test_parameters_are_restored_by_the_next_run(bench, tmp_path) -> None:
    board = px4(has_firmware=True, forgets=True)
    board.vehicle.parameters.set("RTL_RETURN_ALT", 77.0)
    lose_power_after(board, 0x27, 3, times=3)
    with pytest.raises(FlashingError, match="flashing /dev/ttyBOARD failed: programming failed"):
        bench(board, firmware())
    assert board.in_bootloader
    assert [path.name for path in tmp_path.iterdir()] == ["dev-ttyBOARD.params"]
    result = bench(board, firmware())
    assert result.restored.set >= 1
    assert board.vehicle.parameters["RTL_RETURN_ALT"] == 77


def test_nothing_answers(bench) -> None:
    class Nothing(SimulatedBoard):
        def receive(self, data, now):
            self.in_bootloader = True

        def output(self):
            return b""

    with pytest.raises(FlashingError, match="no bootloader answers; unplug the board"):
        bench(Nothing("px4", SMALL), firmware())
    with pytest.raises(FlashingError, match="neither a bootloader nor an autopilot answers"):
        bench(Nothing("px4", SMALL), firmware(), dry_run=True)


def test_a_bootloader_without_a_host_starts_its_firmware() -> None:
    board = px4(has_firmware=True)
    board.power_cycle(10.0)
    board.handle_timeout(10.0)
    assert board.next_timeout() == 15.0
    board.handle_timeout(15.0)
    assert not board.in_bootloader
