"""HIGH_LATENCY2 in place of the streams: when it is sent, by which command, and what readers make of it."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.sim import Simulation
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.harness import CMD, RESULT, SimulationHarness, VehicleHarness
from tests.sim.running import make_ready, running

LINKS = {"ardupilot": ("SERIAL1_PROTOCOL", 43), "px4": ("MAV_0_MODE", 6)}
ACCEPTED, FAILED = RESULT.ACCEPTED, RESULT.FAILED


def harness_of(firmware: str, *, high_latency: bool) -> VehicleHarness:
    harness = SimulationHarness(seed=1)
    vehicle = VehicleHarness(harness, harness.simulation.add("copter", firmware))
    harness.attach(vehicle)
    if high_latency:
        vehicle.vehicle.parameters.set(*LINKS[firmware])
    vehicle.vehicle.reboot()
    assert vehicle.port
    vehicle.receiving = True
    vehicle.run(10)
    return vehicle


def sent(harness: VehicleHarness, seconds: float) -> set[type]:
    before = len(harness.received)
    harness.run(seconds)
    return {type(message) for message in harness.received[before:]}


def test_the_command_starts_and_ends_it():
    harness = harness_of("ardupilot", high_latency=True)
    quiet = {common.Statustext, common.Event, common.CurrentEventSequence}
    assert sent(harness, 5) <= quiet
    assert harness.command(CMD.CONTROL_HIGH_LATENCY, 1) == ACCEPTED
    kinds = sent(harness, 140)
    assert common.HighLatency2 in kinds
    assert common.Heartbeat not in kinds
    assert common.Attitude not in kinds
    times = [m.timestamp / 1e3 for m in harness.received if isinstance(m, common.HighLatency2)]
    assert times[2] - times[1] == pytest.approx(5.0, abs=0.1)
    assert harness.command(CMD.CONTROL_HIGH_LATENCY, 0) == ACCEPTED
    assert common.HighLatency2 not in sent(harness, 140)
    assert harness.command(CMD.CONTROL_HIGH_LATENCY, 2) == FAILED


def test_px4_sends_it_while_no_ground_station_is_heard():
    harness = harness_of("px4", high_latency=True)
    sent(harness, 1)
    assert common.HighLatency2 not in sent(harness, 70)  # the harness sends heartbeats
    assert harness.command(CMD.CONTROL_HIGH_LATENCY, 1) == ACCEPTED
    sent(harness, 1)
    assert common.HighLatency2 not in sent(harness, 70)  # the command lasted until the next status
    harness.sends_heartbeats = False
    before = len(harness.received)
    assert common.HighLatency2 not in sent(harness, 9)
    assert common.HighLatency2 in sent(harness, 2)  # COM_DL_LOSS_T is 10 s
    assert common.Heartbeat not in sent(harness, 170)
    reports = [m for m in harness.received[before:] if isinstance(m, common.HighLatency2)]
    assert (reports[1].timestamp - reports[0].timestamp) / 1e3 == pytest.approx(200 / 3, abs=0.1)


@pytest.mark.parametrize(("firmware", "answer"), [("ardupilot", ACCEPTED), ("px4", FAILED)])
def test_without_such_a_link(firmware, answer):
    harness = harness_of(firmware, high_latency=False)
    assert harness.command(CMD.CONTROL_HIGH_LATENCY, 1) == answer
    kinds = sent(harness, 8)
    assert common.HighLatency2 not in kinds
    assert common.Heartbeat in kinds


@pytest.mark.parametrize("firmware", LINKS)
def test_readers_take_the_values(firmware):
    async def work() -> None:
        simulation = Simulation(seed=1)
        simulated = simulation.add("copter", firmware)
        simulated.parameters.set(*LINKS[firmware])
        simulated.reboot()
        make_ready(simulation)
        network = MemoryNetwork()
        link = network.link()
        async with running(simulation, network.link()), connect(link, heartbeat=False) as connection:
            if firmware == "ardupilot":
                await connection.component(1, 1).command(CMD.CONTROL_HIGH_LATENCY, 1)
            vehicle = await connection.wait_for_vehicle(timeout=100)
            async with vehicle.component.stream(common.HighLatency2) as reports:
                await anext(reports)
            here = simulated.body.frame.to_global(0, 0, 0)
            assert vehicle.info.high_latency
            assert vehicle.position.latitude == pytest.approx(here[0], abs=1e-3)
            assert vehicle.battery.remaining > 90
            assert vehicle.mode == {"ardupilot": "STABILIZE", "px4": "LOITER"}[firmware]
            if firmware == "ardupilot":
                assert vehicle.armed is False

    run_virtually(work())
