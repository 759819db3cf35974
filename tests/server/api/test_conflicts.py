"""Two vehicles with one system id: the API shows both, refuses to act, and gives one another id."""

from __future__ import annotations

import asyncio
import json
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

import pytest

from mavstack.links import MemoryNetwork
from mavstack.server.access import Access
from mavstack.server.api import conflicts
from mavstack.server.api.events import EventsQuery
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import SystemIdConflict
from tests.server.asgi import ApiClient
from tests.sim.running import make_ready, reduce_telemetry, running

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

ACTIONS = {
    "POST arm": {},
    "POST disarm": {},
    "POST mode": {"mode": "LOITER"},
    "POST takeoff": {"altitude": 5},
    "POST reboot": {},
    "POST home": {},
    "PUT parameters/RTL_ALT": {"value": 1234},
    "POST command": {"command": 400, "params": [1]},
}


class Field:
    """A station that hears two simulations, each over its own link."""

    def __init__(self, station: Station, api: ApiClient, simulations: list[Simulation]) -> None:
        self.station, self.api = station, api
        self.vehicles = [simulation.vehicles[0] for simulation in simulations]

    async def conflict(self) -> dict:
        async with asyncio.timeout(10):
            while (found := (await self.api.get("/api/vehicles/1")).json["conflict"]) is None:  # noqa: ASYNC110
                await asyncio.sleep(0.2)
        return found

    def states(self) -> list[tuple]:
        return [
            (
                each.autopilot.armed,
                each.autopilot.mode.name,
                each.boots,
                each.parameters.table["RTL_ALT"].value,
            )
            for each in self.vehicles
        ]


@asynccontextmanager
async def field(firmware=Firmware.ARDUPILOT, systems=(1, 1)) -> AsyncIterator[Field]:
    simulations = []
    for site, system in enumerate(systems):
        simulation = Simulation(seed=5, site=site)
        reduce_telemetry(simulation.add(VehicleType.COPTER, firmware, home=DEFAULT_HOME, system=system))
        make_ready(simulation)
        simulations.append(simulation)
    networks = [MemoryNetwork(), MemoryNetwork()]
    station = Station(telemetry=False)
    async with (
        running(simulations[0], networks[0].link()),
        running(simulations[1], networks[1].link()),
        station,
    ):
        for network in networks:
            await station.sources.add(network.link())
        await station.connection.wait_for_vehicle(1)
        yield Field(station, ApiClient(make_app(station, Access(), static=None)), simulations)


def test_two_vehicles_that_started_together_at_one_place_are_noticed_and_nothing_acts() -> None:
    async def run() -> None:
        async with field() as world:
            conflict = await world.conflict()
            assert conflict["differs"] == ["unique id"]
            assert conflict["chosen"] is None
            assert len({each["channel"] for each in conflict["senders"]}) == 2
            assert len({each["unique_id"] for each in conflict["senders"]}) == 2
            before = world.states()
            for action, body in ACTIONS.items():
                method, path = action.split()
                send = world.api.post if method == "POST" else world.api.put
                answer = await send(f"/api/vehicles/1/{path}", body)
                assert (answer.status, answer.kind) == (409, "SystemIdConflictError"), action
                for sender in conflict["senders"]:
                    assert sender["channel"] in answer.problem
            assert world.states() == before

    run_virtually(run())


def test_the_chosen_one_acts_and_the_other_one_does_not() -> None:
    async def run() -> None:
        async with field() as world:
            conflict = await world.conflict()
            name = conflict["senders"][1]["channel"]
            chosen = (await world.api.post("/api/vehicles/1/sender", {"channel": name})).json
            assert chosen["conflict"]["chosen"] == name
            assert [each["chosen"] for each in chosen["conflict"]["senders"]].count(True) == 1
            assert (await world.api.post("/api/vehicles/1/arm", {})).status == 200
            assert sorted(each.autopilot.armed for each in world.vehicles) == [False, True]
            back = await world.api.post("/api/vehicles/1/sender", {"channel": None})
            assert back.json["conflict"]["chosen"] is None
            assert (await world.api.post("/api/vehicles/1/disarm", {})).status == 409
            assert (await world.api.post("/api/vehicles/1/sender", {"channel": "x"})).status == 400

    run_virtually(run())


@pytest.mark.parametrize("firmware", list(Firmware))
def test_renumber_gives_the_chosen_one_a_free_id(firmware) -> None:
    async def run() -> None:
        async with field(firmware) as world:
            refused = await world.api.post("/api/vehicles/1/renumber", {})
            assert (refused.status, refused.kind) == (409, "SystemIdConflictError")
            sender = (await world.conflict())["senders"][0]
            answer = await world.api.post("/api/vehicles/1/renumber", {"channel": sender["remote"]})
            assert answer.status == 200, answer.problem
            assert answer.json["id"] == 2
            assert answer.json["rebooted"] is True
            assert sorted(each.address.system for each in world.vehicles) == [1, 2]
            assert not world.station.vehicle(1).has_id_conflict
            for system in (1, 2):
                await world.station.vehicle(system).set_mode(
                    "LOITER" if firmware is Firmware.ARDUPILOT else "HOLD"
                )
            used = await world.api.post("/api/vehicles/1/renumber", {"id": 2})
            assert used.status == 400

    run_virtually(run())


def test_a_vehicle_that_gets_the_id_by_parameter_and_reboot_is_noticed() -> None:
    async def run() -> None:
        async with field(systems=(1, 7)) as world:
            connection = world.station.connection
            other = await connection.wait_for_vehicle(7)
            async with connection.events(SystemIdConflict) as events:
                await other.params.set("SYSID_THISMAV", 1)
                await other.reboot(wait=False)
                rebooted_at = connection.now()
                event = await asyncio.wait_for(anext(events), 30)
            assert connection.now() - rebooted_at < 15
            assert event.vehicle.system == 1
            assert "unique id" in event.differs

    run_virtually(run())


def test_events_are_a_stream() -> None:
    async def run() -> None:
        async with field(systems=(1, 7)) as world:
            other = await world.station.connection.wait_for_vehicle(7)
            call = type("Call", (), {"station": world.station, "query": EventsQuery(count=1)})()
            lines = conflicts._event_lines(call)
            line = asyncio.ensure_future(anext(lines))
            await asyncio.sleep(0)
            await other.renumber(9)
            event = json.loads((await line).removeprefix("data: "))
            assert event["system"] == 9
            assert event["type"] == "VehicleFound"
            assert event["conflict"] is None
            assert [each async for each in lines] == []

    run_virtually(run())


def test_identity_parameters_are_one_list() -> None:
    async def run() -> None:
        async with field() as world:
            names = (await world.api.get("/api/identity-parameters")).json["names"]
            assert {"SYSID_THISMAV", "MAV_SYSID", "MAV_SYS_ID"} <= set(names)

    run_virtually(run())
