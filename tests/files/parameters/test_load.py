"""Loading a parameter file into a vehicle: the outcome of each parameter, in a sensible order."""

from __future__ import annotations

import asyncio
from collections import Counter

import pytest

from mavstack.dialects import common
from mavstack.errors import ParameterTimeout
from mavstack.files.parameters import Outcome, ParameterFile, ParameterLoad, StoredParameter, apply
from mavstack.links import Impairment, MemoryNetwork, impair
from mavstack.node import Node
from mavstack.pytest_plugin import VirtualVehicle
from mavstack.services.parameters import (
    ParameterDefinition,
    ParameterServer,
    ParameterTable,
    ParameterWritten,
)
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

SET, UNCHANGED, SKIPPED = Outcome.SET, Outcome.UNCHANGED, Outcome.SKIPPED
REFUSED, UNKNOWN, UNANSWERED, UNTRIED = Outcome.REFUSED, Outcome.UNKNOWN, Outcome.UNANSWERED, Outcome.UNTRIED


def wanted(**values):
    return [StoredParameter(name, value) for name, value in values.items()]


def load_into(firmware, parameters, **options):
    """Load parameters into a simulated copter; return the results by name, and the vehicle afterwards."""
    flown = VirtualVehicle("copter", firmware)

    async def flight(remote):
        return await apply(remote.params, parameters, **options)

    return {each.name: each for each in flown.run(flight)}, flown.vehicle


def outcomes(results):
    return {name: each.outcome for name, each in results.items()}


def test_a_result_for_each_parameter():
    given = wanted(RTL_ALT=3000, RTL_SPEED=0, STAT_RUNTIME=7, SYSID_THISMAV=9, FOO_BAR=1, RTL_ALT_TYPE=300)
    results, vehicle = load_into("ardupilot", given)
    assert outcomes(results) == {
        "RTL_ALT": SET,
        "RTL_SPEED": UNCHANGED,
        "STAT_RUNTIME": SKIPPED,
        "SYSID_THISMAV": SKIPPED,
        "FOO_BAR": UNKNOWN,
        "RTL_ALT_TYPE": REFUSED,
    }
    assert vehicle.parameters["RTL_ALT"] == 3000
    assert vehicle.parameters["SYSID_THISMAV"] == 1
    assert (results["RTL_ALT"].before.value, results["RTL_ALT"].after.value) == (1500, 3000)
    assert results["RTL_ALT_TYPE"].reason == "its type INT8 cannot hold 300"
    assert results["STAT_RUNTIME"].reason == "the vehicle counts or measures it itself"
    assert [name for name, each in results.items() if not each.ok] == ["FOO_BAR", "RTL_ALT_TYPE"]


def test_the_vehicles_own_reason():
    results, vehicle = load_into("ardupilot", wanted(FORMAT_VERSION=7), everything=True)
    result = results["FORMAT_VERSION"]
    assert (result.outcome, result.reason) == (REFUSED, "READ_ONLY")
    assert vehicle.parameters["FORMAT_VERSION"] == 120


def test_parameters_marked_read_only():
    parameters = [StoredParameter("RTL_ALT", 3000, read_only=True)]
    assert outcomes(load_into("ardupilot", parameters)[0]) == {"RTL_ALT": SKIPPED}
    assert outcomes(load_into("ardupilot", parameters, everything=True)[0]) == {"RTL_ALT": SET}


def test_a_dry_run_sends_nothing():
    results, vehicle = load_into("px4", wanted(MPC_XY_CRUISE=7.5, NOPE=1), dry_run=True)
    assert outcomes(results) == {"MPC_XY_CRUISE": SET, "NOPE": UNKNOWN}
    assert vehicle.parameters["MPC_XY_CRUISE"] == 5.0


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_saved_parameters_are_unchanged(firmware):
    flown = VirtualVehicle("copter", firmware)

    async def flight(remote):
        file = ParameterFile.of((await remote.params.download()).values())
        return await ParameterLoad(remote.params, file.parameters, everything=True).run()

    results = flown.run(flight)
    assert (
        Counter(each.outcome for each in results)[UNCHANGED] >= len(results) - 1
    )  # the vehicle counts its uptime


def test_names_in_the_wrong_case():
    results, _ = load_into("ardupilot", wanted(rtl_alt=2000))
    assert outcomes(results) == {"RTL_ALT": SET}


def test_the_system_id_is_set_last_and_only_if_requested():
    progress = []
    given = wanted(SYSID_THISMAV=9, RTL_ALT=3000, WPNAV_SPEED=700)
    results, vehicle = load_into(
        "ardupilot", given, everything=True, on_result=lambda each: progress.append(each.name)
    )
    assert progress[-1] == "SYSID_THISMAV"
    assert results["SYSID_THISMAV"].outcome is SET
    assert vehicle.parameters["SYSID_THISMAV"] == 9


class Peer:
    """An autopilot with a parameter server only; `reveals` names the parameters that appear after a set."""

    def __init__(self, reveals=(), **values) -> None:
        self.table = ParameterTable()
        for name, value in values.items():
            self.table.add(ParameterDefinition(name, value))
        self.reveals = dict(reveals)
        self.written = []
        self.silent_after = None

    async def serve(self, network):
        node = Node(
            network.link(),
            system=1,
            component=1,
            type=common.MavType.QUADROTOR,
            autopilot=common.MavAutopilot.PX4,
        )
        async with node:
            server = ParameterServer(node.address)
            server.table = self.table
            node.serve(server)
            async with node.events(ParameterWritten, of=server) as events:
                async for event in events:
                    self._written(event.parameter)
                    if self.silent_after == len(self.written):
                        return

    def _written(self, parameter):
        self.written.append(parameter.name)
        for name, value in self.reveals.get(parameter.name, {}).items():
            if parameter.value and name not in self.table:
                self.table.add(ParameterDefinition(name, value))


def run_with(peer, scenario, **conditions):
    async def run():
        network = MemoryNetwork()
        serving = asyncio.create_task(peer.serve(network))
        link = impair(network.link(), Impairment(**conditions)) if conditions else network.link()
        try:
            async with connect(link) as node:
                return await scenario((await node.wait_for_vehicle()).params)
        finally:
            serving.cancel()

    return run_virtually(run())


REVEALING = {"Q_ENABLE": {"Q_TILT_ENABLE": 0, "Q_A_P": 4.5}, "Q_TILT_ENABLE": {"Q_TILT_MASK": 0}}


def test_parameters_that_reveal_others_are_set_first():
    peer = Peer(REVEALING, Q_ENABLE=0, RTL_ALT=1500)
    given = wanted(Q_TILT_MASK=3, Q_A_P=5.0, RTL_ALT=2000, Q_TILT_ENABLE=1, Q_ENABLE=1, Q_NEVER=1)

    async def scenario(params):
        return await ParameterLoad(params, given).run()

    results = run_with(peer, scenario)
    assert [each.name for each in results] == [each.name for each in given]
    assert {each.name: each.outcome for each in results} == {
        "Q_TILT_MASK": SET,
        "Q_A_P": SET,
        "RTL_ALT": SET,
        "Q_TILT_ENABLE": SET,
        "Q_ENABLE": SET,
        "Q_NEVER": UNKNOWN,
    }
    assert peer.written[0] == "Q_ENABLE"
    assert peer.table["Q_TILT_MASK"].value == 3


def test_over_a_lossy_link():
    peer = Peer(REVEALING, Q_ENABLE=0, **{f"P{number}": number for number in range(60)})
    given = wanted(Q_ENABLE=1, Q_A_P=6.0, **{f"P{number}": number + 1 for number in range(60)})

    async def scenario(params):
        return await ParameterLoad(params, given).run()

    results = run_with(peer, scenario, loss=0.2, latency=0.1, seed=4)
    assert {each.outcome for each in results} == {SET}
    assert peer.table["P59"].value == 60


def test_a_vehicle_that_stops_answering_has_a_result_for_each_parameter():
    peer = Peer(**{f"P{number}": number for number in range(40)})
    peer.silent_after = 5
    given = wanted(**{f"P{number}": number + 1 for number in range(40)})

    async def scenario(params):
        return await ParameterLoad(params, given).run()

    results = run_with(peer, scenario)
    counts = Counter(each.outcome for each in results)
    assert set(counts) == {SET, UNANSWERED, UNTRIED}
    assert counts[SET] >= 4
    assert counts[UNANSWERED] <= 16
    assert {each.reason for each in results if each.outcome is UNTRIED} == {"the vehicle no longer answers"}


def test_a_vehicle_that_has_no_parameters_is_an_error():
    async def scenario(params):
        with pytest.raises(ParameterTimeout):
            await ParameterLoad(params, wanted(A=1)).run(timeout=5.0)
        return True

    assert run_with(Peer(), scenario)


def test_a_cancelled_load_keeps_its_results():
    peer = Peer(**{f"P{number}": number for number in range(200)})
    given = wanted(**{f"P{number}": number + 1 for number in range(200)})

    async def scenario(params):
        seen = asyncio.Event()
        load = ParameterLoad(params, given, on_result=lambda each: seen.set())
        task = asyncio.create_task(load.run())
        await seen.wait()
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        return load.results

    counts = Counter(each.outcome for each in run_with(peer, scenario, latency=0.1))
    assert counts[SET] >= 1
    assert counts[UNTRIED] > 100
    assert counts.total() == 200


def test_a_value_that_the_vehicle_clamps_is_a_refusal():
    async def scenario(params):
        return await ParameterLoad(params, wanted(A=700)).run()

    peer = Peer()
    peer.table.add(ParameterDefinition("A", 5, common.MavParamType.INT32, minimum=0, maximum=100))
    (result,) = run_with(peer, scenario)
    assert result.outcome is REFUSED
    assert result.reason
