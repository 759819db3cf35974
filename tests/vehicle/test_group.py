"""Group calls: each vehicle has its own result, also if other vehicles fail."""

from __future__ import annotations

import asyncio
import pickle

import pytest

from mavstack.dialects import common
from mavstack.errors import (
    CommandDenied,
    CommandTimeout,
    GroupError,
    LocalProtocolError,
    MavstackError,
    RemoteCancelled,
    RemoteTimeout,
)
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle import Group, VehicleFound, VehicleLost
from tests.sim.running import reduce_telemetry
from tests.vehicle.peers import run_scenario
from tests.vehicle.world import ARDUPILOT, PX4, fly


def with_group(count, scenario):
    """Run a scenario with a group of scripted vehicles, which answer nothing."""

    async def whole(harness):
        for system in range(1, count + 1):
            await harness.add_peer(system)
        await scenario(harness, await harness.connection.wait_for_vehicles(count))

    run_scenario(whole)


def test_each_vehicle_has_its_own_outcome():
    async def scenario(harness, group):
        async def work(vehicle):
            await asyncio.sleep(vehicle.system)
            if vehicle.system == 2:
                raise CommandDenied("arming", "2/1", answer="DENIED", code=2)
            return vehicle.system * 10

        begun = harness.connection.now()
        results = await group.each(work)
        assert harness.connection.now() - begun == pytest.approx(3.0, abs=0.1)  # at the same time
        first, second, third = group
        assert list(results) == [first, second, third]
        assert results[first] == 10
        assert isinstance(results[second], CommandDenied)
        assert results.succeeded == {first: 10, third: 30}
        assert list(results.errors) == list(results.failed) == [second]
        assert not results.ok
        assert len(results) == 3
        with pytest.raises(GroupError) as caught:
            results.check()
        assert isinstance(caught.value, MavstackError)
        assert caught.value.errors == {2: results[second]}
        assert str(caught.value) == "work failed on 1 of 3 vehicles\n  2: arming failed: DENIED"

    with_group(3, scenario)


def test_all_succeed():
    async def scenario(harness, group):
        results = await group.each(lambda vehicle: asyncio.sleep(0, vehicle.system))
        assert results.ok
        assert not results.failed
        assert results.check() == results.succeeded == dict(results)
        assert sorted(results.values()) == [1, 2]

    with_group(2, scenario)


def test_a_defect_of_the_function_is_an_outcome_and_the_cause():
    async def scenario(harness, group):
        def work(vehicle):
            if vehicle.system == 2:
                return {}["nothing"]  # type: ignore[index]  # raised before there is an awaitable
            return asyncio.sleep(1, "done")

        results = await group.each(work)
        assert list(results.succeeded.values()) == ["done", "done"]
        with pytest.raises(GroupError, match="2: KeyError: 'nothing'") as caught:
            results.check()
        assert isinstance(caught.value.__cause__, KeyError)

    with_group(3, scenario)


@pytest.mark.parametrize(("max_concurrency", "expected"), [(1, 1), (3, 3), (100, 8), (None, 8)])
def test_max_concurrency(max_concurrency, expected):
    async def scenario(harness, group):
        running = highest = 0

        async def work(vehicle):
            nonlocal running, highest
            running += 1
            highest = max(highest, running)
            await asyncio.sleep(1)
            running -= 1

        assert (await group.each(work, max_concurrency=max_concurrency)).ok
        assert highest == expected

    with_group(8, scenario)


def test_a_max_concurrency_below_one_is_misuse():
    async def scenario(harness, group):
        with pytest.raises(LocalProtocolError, match="max_concurrency must be at least 1, got 0"):
            await group.each(lambda vehicle: asyncio.sleep(0), max_concurrency=0)

    with_group(1, scenario)


def test_cancelling_cancels_all_and_leaves_each_end_clean():
    async def scenario(harness, group):
        cancelled = []
        for peer in harness.peers:
            peer.node.add_packet_listener(
                common.CommandCancel, lambda packet, peer=peer: cancelled.append(peer.node.address.system)
            )
        command = common.MavCmd.DO_SET_HOME
        asking = asyncio.create_task(
            group.each(lambda vehicle: vehicle.component.command(command, 1), max_concurrency=2)
        )
        await asyncio.sleep(1)
        asking.cancel()
        with pytest.raises(asyncio.CancelledError):
            await asking
        await asyncio.sleep(1)
        assert sorted(cancelled) == [1, 2]  # the third call had not begun
        assert not any(vehicle.component._clients.command.busy for vehicle in group)

    with_group(3, scenario)


def test_work_that_cancels_itself_is_an_outcome():
    async def scenario(harness, group):
        async def work(vehicle):
            if vehicle.system == 1:
                raise asyncio.CancelledError

        results = await group.each(work)
        assert list(results.failed) == [harness.connection.vehicles[1]]
        (error,) = results.errors.values()
        assert isinstance(error, RemoteCancelled)

    with_group(2, scenario)


def test_vehicles_that_fail_for_one_reason_share_a_line():
    errors = {
        system: CommandTimeout("arming", f"{system}/1", attempts=6, answer="no answer")
        for system in range(1, 4)
    }
    errors[9] = CommandDenied("arming", "9/1", answer="DENIED")
    errors[9].status_texts = ("PreArm: GPS 1: bad fix",)
    error = GroupError("arming", errors, 50)
    assert str(error) == (
        "arming failed on 4 of 50 vehicles\n"
        "  1, 2, 3: arming failed after 6 attempts: no answer\n"
        "  9: arming failed: DENIED (PreArm: GPS 1: bad fix)"
    )
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert again.errors.keys() == error.errors.keys()


def test_a_vehicle_is_in_a_group_once():
    async def scenario(harness, group):
        vehicle = harness.connection.vehicles[1]
        twice = Group([vehicle, *group, vehicle])
        assert twice.systems == (1, 2)
        assert vehicle in twice
        assert repr(twice) == "<Group of 1, 2>"
        assert repr(Group([])) == "<Group of no vehicles>"
        assert (await Group([]).arm()).ok

    with_group(2, scenario)


def prepare(simulated):
    reduce_telemetry(simulated)
    if simulated.address.system == 5:
        simulated.faults.inject("gps off")


@pytest.mark.nightly
def test_fifty_vehicles():
    """One of fifty vehicles has no GPS and refuses to arm, one is disconnected; all others take off."""
    kinds = [(VehicleType.COPTER, ARDUPILOT if number % 2 else PX4) for number in range(50)]

    async def scenario(world, vehicle):
        node = world.node
        fleet = await node.wait_for_vehicles(50, timeout=10)
        assert sorted(fleet.systems) == sorted(node.vehicles) == list(range(1, 51))
        events = node.events(VehicleFound, VehicleLost)

        name = {ARDUPILOT: "RTL_ALT", PX4: "RTL_RETURN_ALT"}
        firmware = {each.address.system: each.firmware for each in world.simulation.vehicles}
        wanted = {system: 20 + system for system in fleet.systems}
        results = await fleet.each(
            lambda each: each.params.set(name[firmware[each.system]], wanted[each.system]), max_concurrency=10
        )
        assert {each.system: value.value for each, value in results.check().items()} == wanted
        results = await fleet.each(lambda each: each.params.download())
        assert all(
            parameters[name[firmware[each.system]]].value == wanted[each.system]
            for each, parameters in results.check().items()
        )

        armed = set()
        for each in world.simulation.vehicles:
            each.listeners.append(lambda each, kind, text: text == "armed" and armed.add(each.address.system))
        world.simulation.vehicles[6].cut(True)
        results = await fleet.arm()
        assert {each.system: type(error) for each, error in results.errors.items()} == {
            5: CommandDenied,
            7: CommandTimeout,
        }
        with pytest.raises(GroupError, match="arming failed on 2 of 50 vehicles") as caught:
            results.check()
        assert "\n  5: " in str(caught.value)
        assert "\n  7: " in str(caught.value)
        assert armed == set(fleet.systems) - {5, 7}
        (lost,) = events.drain()
        assert lost.vehicle.system == 7

        with pytest.raises(RemoteTimeout, match=r"for 50 vehicles on .* failed: 49 in 2 s"):
            await node.wait_for_vehicles(50, timeout=2)
        there = await node.wait_for_vehicles(49)
        modes = {ARDUPILOT: "LOITER", PX4: "HOLD"}
        results = await there.each(lambda each: each.set_mode(modes[firmware[each.system]]))
        assert len(results.check()) == 49
        assert {each.component.modes.current for each in there} == {"LOITER"}  # as PX4 calls it within

    fly(kinds, scenario, prepare=prepare)
