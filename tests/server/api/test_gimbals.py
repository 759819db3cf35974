from __future__ import annotations

from typing import Any

from mavstack.links import MemoryNetwork
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from tests.server.asgi import ApiClient
from tests.sim.running import make_ready, reduce_telemetry, running

GIMBALS = "/api/vehicles/1/gimbals"


def with_payloads(scenario: Any) -> None:
    """Run a scenario with a copter that has a camera and a gimbal."""

    async def run() -> None:
        simulation = Simulation(seed=5)
        vehicle = simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT, camera=True, gimbal=True)
        reduce_telemetry(vehicle)
        make_ready(simulation)
        network = MemoryNetwork()
        async with running(simulation, network.link()), Station(telemetry=False) as station:
            await station.sources.add(network.link())
            await station.connection.wait_for_vehicle()
            await scenario(ApiClient(make_app(station, Access(), static=None)))

    run_virtually(run())


def test_a_gimbal_is_found_and_pointed() -> None:
    async def scenario(api: ApiClient) -> None:
        (found,) = (await api.get(GIMBALS)).json
        assert (found["id"], found["in_control"], round(found["information"]["pitch_range"][0])) == (
            "1",
            False,
            -90,
        )
        pointed = (await api.post(f"{GIMBALS}/1/point", {"pitch": -45, "yaw": 20})).json
        assert pointed["in_control"]
        assert (round(pointed["attitude"]["pitch"]), round(pointed["attitude"]["yaw"])) == (-45, 20)
        assert (await api.post(f"{GIMBALS}/1/center")).json["attitude"]["pitch"] > -1
        assert (await api.get(f"{GIMBALS}/1")).json["device"] == 1

    with_payloads(scenario)


def test_control_regions_of_interest_and_rates() -> None:
    async def scenario(api: ApiClient) -> None:
        for path, body in (
            ("control", {}),
            ("turn", {"yaw_rate": 5}),
            ("turn", {}),
            ("roi", {"latitude": 47.4, "longitude": 8.55}),
            ("roi/clear", {}),
            ("retract", {}),
        ):
            answer = await api.post(f"{GIMBALS}/1/{path}", body)
            assert answer.status == 200, (path, answer.data)
        other = await api.post(f"{GIMBALS}/1/roi/vehicle", {"target": 2})
        assert other.problem == "DO_SET_ROI_SYSID on 1/1 failed: UNSUPPORTED"
        assert (await api.post(f"{GIMBALS}/1/control/release")).status == 200
        (found,) = (await api.get(GIMBALS)).json
        assert not found["in_control"]

    with_payloads(scenario)


def test_wrong_gimbals() -> None:
    async def scenario(api: ApiClient) -> None:
        assert (await api.post(f"{GIMBALS}/x/point", {"pitch": 0})).status == 404
        assert (await api.post(f"{GIMBALS}/0-1/point", {"pitch": 0})).status == 404
        nothing = await api.post(f"{GIMBALS}/1/point", {})
        assert (nothing.status, nothing.kind) == (400, "InvalidArgumentError")
        assert (await api.post(f"{GIMBALS}/5/point", {"pitch": 0})).status in (409, 504)

    with_payloads(scenario)
