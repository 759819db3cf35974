from __future__ import annotations

import asyncio

from mavstack.bridges.msp.bridge import MspBridge
from mavstack.links import MemoryNetwork
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.fake_controller import FakeController
from tests.server.asgi import ApiClient
from tests.server.stations import COPTER, PX4_COPTER, Ground, serve
from tests.waiting import wait_until


def test_vehicles_are_listed_and_shown() -> None:
    async def scenario(ground: Ground) -> None:
        listed = (await ground.api.get("/api/vehicles")).json
        assert [(each["system"], each["type"], each["autopilot"]) for each in listed] == [
            (1, "copter", "ARDUPILOTMEGA"),
            (2, "copter", "PX4"),
        ]
        shown = (await ground.api.get("/api/vehicles/1")).json
        assert shown["armed"] is False
        assert shown["capabilities"]["calibrations"]
        assert shown["mode"] == "STABILIZE"
        answer = await ground.api.get("/api/vehicles/9")
        assert (answer.status, answer.kind) == (404, "NotFound")
        assert answer.problem == "no vehicle with system id 9 was found; known: 1, 2"
        for path in ("0", "256", "x", "٣", "1" * 30):
            assert (await ground.api.get(f"/api/vehicles/{path}")).status == 404

    serve([COPTER, PX4_COPTER], scenario)


def test_telemetry_has_values_and_status_texts() -> None:
    async def scenario(ground: Ground) -> None:
        vehicle = ground.station.vehicle(1)
        await ground.wait_until(lambda: vehicle.attitude and vehicle.position and vehicle.home)
        found = (await ground.api.get("/api/vehicles/1/telemetry")).json
        assert abs(found["attitude"]["roll"]) < 5
        assert abs(found["position"]["relative_altitude"]) < 1
        assert found["gps"]["fix"].startswith("RTK") or "3D" in found["gps"]["fix"]
        assert found["home"]["latitude"] == vehicle.home.latitude
        assert found["armed"] is False
        assert isinstance(found["status_texts"], list)
        assert found["landed_state"] == "ON_GROUND"

    serve(COPTER, scenario, full_telemetry=True)


def test_the_modes_of_a_vehicle() -> None:
    async def scenario(ground: Ground) -> None:
        modes = (await ground.api.get("/api/vehicles/1/modes")).json
        assert {"name": "GUIDED", "number": 4}.items() <= next(
            each for each in modes if each["name"] == "GUIDED"
        ).items()

    serve(COPTER, scenario)


def test_the_equipment_of_an_msp_vehicle_is_known() -> None:
    async def run() -> None:
        network = MemoryNetwork(lambda: asyncio.get_running_loop().time() + 1e9)
        async with MspBridge(FakeController(), network.link()), Station() as station:
            await station.sources.add(network.link())
            await station.connection.wait_for_vehicle()
            api = ApiClient(make_app(station, Access(), static=None))
            vehicle = station.vehicle(1)
            await wait_until(lambda: vehicle.capabilities.vtx is not None, now=station.connection.now)
            shown = (await api.get("/api/vehicles/1")).json
            assert shown["firmware"] == "Betaflight"
            assert {"msp": True, "osd": False, "vtx": False}.items() <= shown["capabilities"].items()

    run_virtually(run())
