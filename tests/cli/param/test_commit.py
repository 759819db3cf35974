"""Parameters that outlast a power cycle: each firmware, set by the API, the command line and HTTP."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.bridges.msp.bridge import MspBridge
from mavstack.cli.common import connection as cli_connection
from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.links import MemoryNetwork
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.server.asgi import ApiClient
from tests.sim.running import reduce_telemetry

#: A parameter of each firmware with a value that is not its default.
FIRMWARES = {
    "ardupilot": ("RTL_ALT", 2500),
    "px4": ("RTL_RETURN_ALT", 45),
    "betaflight": ("BF_PID_ROLL_P", 71),
    "inav": ("INAV_MAN_EXPO", 71),
}
MSP = ("betaflight", "inav")


class Bench:
    """A vehicle with a power switch, and programs that connect to it one after the other."""

    def __init__(self, firmware: str) -> None:
        self.firmware = firmware
        self.name, self.value = FIRMWARES[firmware]
        self.simulation = Simulation(seed=5)
        if firmware in MSP:
            self.vehicle = self.simulation.add_flight_controller(firmware)
        else:
            self.vehicle = self.simulation.add(VehicleType.COPTER, firmware)
            reduce_telemetry(self.vehicle)

    @asynccontextmanager
    async def network(self):
        """Run the vehicle, with a bridge if it speaks MSP; yields a network on which it is."""
        line, network = MemoryNetwork(), MemoryNetwork()
        async with Runner(self.simulation) as runner:
            await runner.connect(line.link(), [self.vehicle])
            runner.start()
            if self.firmware not in MSP:
                yield line
                return
            async with FlightController(line.link()) as controller, MspBridge(controller, network.link()):
                yield network

    def run(self, scenario):
        """Run a scenario with a vehicle that a program found."""

        async def work():
            async with self.network() as network, connect(network.link()) as connection:
                return await scenario(await connection.wait_for_vehicle())

        return run_virtually(work())

    def power_cycle(self) -> None:
        self.vehicle.power_cycle()
        self.simulation.advance(self.simulation.now + 3)

    def held(self) -> float:
        """Read the parameter by a new program."""

        async def read(vehicle):
            return (await vehicle.params.get(self.name)).value

        return self.run(read)


def set_by_api(bench, mav, monkeypatch, *, save):
    async def scenario(vehicle):
        await vehicle.params.set(bench.name, bench.value)
        assert vehicle.params.unsaved == ((bench.name,) if bench.firmware in MSP else ())
        if save:
            await vehicle.params.commit()
            assert vehicle.params.unsaved == ()

    bench.run(scenario)


def set_by_command(bench, mav, monkeypatch, *, save):
    words = ["set", bench.name, str(bench.value), "--force"]
    last = run_command(bench, mav, monkeypatch, [*words, *(["--save"] if save else [])])
    if bench.firmware not in MSP and not save:
        assert str(bench.value) in last


def set_by_file(bench, mav, monkeypatch, *, save):
    with TemporaryDirectory() as folder:
        path = Path(folder) / "values.param"
        path.write_text(f"{bench.name},{bench.value}\n", "utf-8")
        run_command(bench, mav, monkeypatch, ["load", str(path), *(["--save"] if save else [])])


def run_command(bench, mav, monkeypatch, words):
    """Run `mav param` beside the vehicle; return its last line, which tells of values that are not saved."""
    networks = []

    async def on_network(work):
        async with bench.network() as network:
            networks.append(network)
            return await work

    monkeypatch.setattr(asyncio, "run", lambda work: run_virtually(on_network(work)))
    monkeypatch.setattr(cli_connection, "connect", lambda *_, **__: connect(networks[-1].link()))
    result = mav("param", *words)
    monkeypatch.undo()
    assert result.code == 0, result
    last = result.out.splitlines()[-1]
    if "--save" in words:
        assert last == "vehicle 1: saved"
    elif bench.firmware in MSP:
        assert last == "vehicle 1: not yet saved; --save keeps these values over a restart"
    return last


def set_by_http(bench, mav, monkeypatch, *, save):
    async def scenario():
        async with bench.network() as network, Station(telemetry=False) as station:
            await station.sources.add(network.link())
            await station.connection.wait_for_vehicles(1)
            api = ApiClient(make_app(station, Access(), static=None))
            answer = await api.put(f"/api/vehicles/1/parameters/{bench.name}", {"value": bench.value})
            unsaved = bench.firmware in MSP
            assert (answer.status, answer.json["saved"]) == (200, not unsaved)
            assert (await api.get("/api/vehicles/1")).json["unsaved_parameters"] == unsaved
            if save:
                assert (await api.post("/api/vehicles/1/commit-parameters")).status == 200
                listed = (await api.get("/api/vehicles/1/parameters?cached=true")).json
                assert listed["unsaved"] == []

    run_virtually(scenario())


WAYS = [set_by_api, set_by_command, set_by_file, set_by_http]


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("firmware", FIRMWARES)
def test_a_saved_value_outlasts_a_power_cycle(firmware, way, mav, monkeypatch) -> None:
    bench = Bench(firmware)
    assert bench.held() != bench.value
    way(bench, mav, monkeypatch, save=True)
    bench.power_cycle()
    assert bench.held() == bench.value


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("firmware", MSP)
def test_a_value_that_is_not_saved_is_lost(firmware, way, mav, monkeypatch) -> None:
    bench = Bench(firmware)
    before = bench.held()
    way(bench, mav, monkeypatch, save=False)
    assert bench.held() == bench.value
    bench.power_cycle()
    assert bench.held() == before


@pytest.mark.parametrize(("seconds", "kept"), [(0.5, False), (3, True)])
def test_px4_saves_by_itself_after_some_seconds(seconds, kept) -> None:
    bench = Bench("px4")

    async def scenario(vehicle):
        await vehicle.params.set(bench.name, bench.value)
        await asyncio.sleep(seconds)

    bench.run(scenario)
    bench.power_cycle()
    assert (bench.held() == bench.value) is kept


def test_an_armed_vehicle_does_not_save() -> None:
    bench = Bench("px4")

    async def scenario(vehicle):
        await vehicle.wait_until_ready()
        await vehicle.arm()
        with pytest.raises(CommandDenied) as denied:
            await vehicle.params.commit()
        assert denied.value.code == common.MavResult.TEMPORARILY_REJECTED

    bench.run(scenario)


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_a_restart_ends_what_was_not_saved(firmware) -> None:
    bench = Bench(firmware)

    async def scenario(vehicle):
        await vehicle.params.set(bench.name, bench.value)
        await vehicle.reboot()
        assert vehicle.params.unsaved == ()

    bench.run(scenario)
