"""Firmware by HTTP: ports, files, flashing with progress, refusals."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

import pytest

from mavstack.flashing import autopilot_board, backup, board_flasher, bootloader_port
from mavstack.flashing.json_container import make_container
from mavstack.flashing.ports import PortInfo
from mavstack.flashing.simulated_board import SimulatedBoard
from mavstack.flashing.simulated_bootloader import PX4_BOARD
from mavstack.flashing.simulated_port import SimulatedPort
from mavstack.links import MemoryNetwork
from mavstack.server.access import Access
from mavstack.server.api import firmware as routes
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.server.asgi import ApiClient

FLASH = "/api/firmware/flash?port=/dev/ttyACM7"
FILE = make_container(b"\x00\x10\x00\x20" + bytes(9000), 50, image_maxsize=2_064_384)
WRONG = make_container(b"\x00\x10\x00\x20" + bytes(9000), 9)
BYTES = {"content-type": "application/octet-stream"}


@pytest.fixture
def serve(monkeypatch, tmp_path):
    """Run a scenario with a station, and a board at a serial port of it."""

    def run(scenario, board):
        network = MemoryNetwork()
        monkeypatch.setattr(board_flasher, "_devices", frozenset)
        monkeypatch.setattr(bootloader_port, "open_link", lambda url: network.link())
        monkeypatch.setattr(autopilot_board, "connect", lambda url: connect(network.link()))
        monkeypatch.setattr(backup, "state_directory", lambda: tmp_path)

        @asynccontextmanager
        async def station():
            async with SimulatedPort(board, network.link()), Station(telemetry=False) as opened:
                yield ApiClient(make_app(opened, Access(), static=None))

        async def work():
            async with station() as api:
                await scenario(api)

        run_virtually(work())

    return run


def board(**options) -> SimulatedBoard:
    return SimulatedBoard("px4", PX4_BOARD, **options)


def test_ports_and_the_board_at_one(serve, monkeypatch) -> None:
    monkeypatch.setattr(routes, "list_ports", lambda: [PortInfo("/dev/ttyACM7", "PX4 FMUv5")])

    async def scenario(api):
        found = (await api.get("/api/firmware/ports")).json
        assert found["ports"][0]["device"] == "/dev/ttyACM7"
        assert set(found["tools"]) == {"dfu-util", "esptool"}
        shown = await api.get("/api/firmware/board?port=/dev/ttyACM7")
        assert (shown.status, shown.json["board"], shown.json["flash_size"]) == (200, 50, 2_064_384)

    serve(scenario, board())


def test_no_bootloader_answers(serve) -> None:
    async def scenario(api):
        answer = await api.get("/api/firmware/board?port=/dev/ttyACM7")
        assert (answer.status, answer.problem) == (404, "no bootloader answers at /dev/ttyACM7")

    serve(scenario, board(has_firmware=True))


def test_a_file_is_checked(serve) -> None:
    async def scenario(api):
        facts = await api.request("POST", "/api/firmware/check?name=a.px4", data=FILE, headers=BYTES)
        assert (facts.status, facts.json["kind"], facts.json["board"]) == (200, "px4", 50)
        damaged = await api.request("POST", "/api/firmware/check?name=a.px4", data=FILE[:99], headers=BYTES)
        assert (damaged.status, damaged.kind) == (400, "FirmwareFileError")
        assert "a.px4: not JSON, the file may be cut off" in damaged.problem

    serve(scenario, board())


def test_a_board_is_flashed(serve) -> None:
    device = board(has_firmware=True, forgets=True)
    device.vehicle.parameters.set("RTL_RETURN_ALT", 77.0)

    async def scenario(api):
        tried = await api.request("POST", f"{FLASH}&dry_run=true", data=FILE, headers=BYTES)
        assert (tried.status, tried.json["written"]) == (200, 0)
        answer = await api.request("POST", FLASH, data=FILE, headers=BYTES)
        assert (answer.status, answer.json["written"]) == (200, 9004)
        assert answer.json["parameters"]["set"] >= 1

    serve(scenario, device)
    assert device.vehicle.parameters["RTL_RETURN_ALT"] == 77


def test_progress_of_a_task(serve) -> None:
    async def scenario(api):
        begun = await api.request("POST", f"{FLASH}&wait=false", data=FILE, headers=BYTES)
        assert begun.status == 202
        steps = []
        for _ in range(400):
            task = (await api.get(f"/api/tasks/{begun.json['task']}")).json
            steps.append(task.get("step"))
            if task["state"] != "running":
                break
            await asyncio.sleep(0.01)
        assert task["state"] == "done"
        assert steps[-1] == {"phase": "done"}

    serve(scenario, board())


def test_refusals(serve) -> None:
    device = board()

    async def scenario(api):
        wrong = await api.request("POST", FLASH, data=WRONG, headers=BYTES)
        assert (wrong.status, wrong.kind) == (409, "FlashingRefused")
        assert "the firmware is for board 9" in wrong.problem
        path = "/api/firmware/flash?port=unix:///tmp/x"
        assert (await api.request("POST", path, data=FILE, headers=BYTES)).status == 403
        both = await asyncio.gather(*(api.request("POST", FLASH, data=FILE, headers=BYTES) for _ in range(2)))
        assert sorted(each.status for each in both) == [200, 409]

    serve(scenario, device)
    assert not device.in_bootloader
