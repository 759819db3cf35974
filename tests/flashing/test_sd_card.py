"""ArduPilot's way by the SD card: upload, restart, outcome."""

from __future__ import annotations

import pytest

from mavstack.flashing import (
    FlashingError,
    FlashingRefused,
    FlashOptions,
    flash_firmware,
    parse_firmware,
    sd_card,
)
from mavstack.flashing.abin import make_abin
from mavstack.links import MemoryNetwork
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.running import reduce_telemetry, running

ABIN = make_abin(bytes(range(256)) * 20)


@pytest.fixture
def run(monkeypatch):
    """Flash a simulated vehicle; returns the result and the vehicle."""

    def flash(firmware="ardupilot", board_id=140, prepare=None, **options):
        simulation = Simulation(seed=5)
        vehicle = simulation.add(VehicleType.COPTER, firmware)
        vehicle.board_id = board_id
        reduce_telemetry(vehicle)
        if prepare is not None:
            prepare(vehicle)
        network = MemoryNetwork()
        monkeypatch.setattr(sd_card, "connect", lambda url: connect(network.link()))

        async def work():
            async with running(simulation, network.link()):
                return await flash_firmware(
                    parse_firmware(ABIN), "udpin://0.0.0.0:14550", FlashOptions(**options)
                )

        return run_virtually(work()), vehicle

    return flash


def test_the_bootloader_flashes_the_file(run) -> None:
    def old_file(vehicle) -> None:
        vehicle.storage.store["/ardupilot-failed.abin"] = b"old"

    result, vehicle = run(prepare=old_file)
    assert result.written == len(ABIN)
    assert vehicle.storage.store["/ardupilot-flashed.abin"] == ABIN
    assert "/ardupilot-failed.abin" not in vehicle.storage.store
    assert vehicle.boots == 2


def test_a_dry_run(run) -> None:
    result, vehicle = run(dry_run=True)
    assert result.written == 0
    assert vehicle.boots == 1
    assert "/ardupilot.abin" not in vehicle.storage.store


def test_a_board_whose_bootloader_does_not_look(run) -> None:
    with pytest.raises(FlashingError, match="its bootloader did not look at the SD card"):
        run(board_id=None)


def test_a_damaged_file(run, monkeypatch) -> None:
    monkeypatch.setattr(
        "mavstack.sim.ardupilot.sd_card.md5", lambda *_, **__: type("Sum", (), {"hexdigest": str})()
    )
    monkeypatch.setattr("mavstack.sim.ardupilot.sd_card._SEPARATOR", b"==")
    with pytest.raises(FlashingError, match="found no valid image"):
        run()


def test_px4_and_armed_vehicles_are_refused(run) -> None:
    with pytest.raises(FlashingRefused, match="only ArduPilot takes"):
        run("px4")
    with pytest.raises(FlashingRefused, match="it is armed; disarm it first"):
        run(prepare=lambda vehicle: vehicle.autopilot.arm(force=True))
