"""Rates: held while they are wanted, and asked for again when the vehicle may have forgotten them."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.running import reduce_telemetry
from tests.vehicle.telemetry.harness import PX4, RESULT, with_peer
from tests.vehicle.world import ARDUPILOT, fly
from tests.vehicle.world import PX4 as SIMULATED_PX4

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, SIMULATED_PX4)]
ATTITUDE, ODOMETRY = 30, 331


def boot_time(seconds):
    return common.SystemTime(time_boot_ms=int(seconds * 1000))


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=lambda kind: kind[1])
def test_rates_are_requested_again_after_a_reboot(kind):
    async def scenario(world, vehicle):
        await vehicle.set_message_rate(common.HighresImu, 10)
        await asyncio.sleep(2)
        assert vehicle.age(common.HighresImu) < 0.2
        world.simulated.reboot()
        await asyncio.sleep(15)
        assert vehicle.age(common.HighresImu) < 0.2

    fly(kind, scenario, prepare=reduce_telemetry)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=lambda kind: kind[1])
def test_rates_are_requested_again_after_a_reboot_during_a_link_outage(kind):
    async def scenario(world, vehicle):
        async with vehicle.stream(common.HighresImu, rate=10):
            await asyncio.sleep(2)
            world.simulated.faults.inject("link off")
            await asyncio.sleep(20)
            world.simulated.reboot()
            await asyncio.sleep(5)
            world.simulated.faults.inject("link on")
            await asyncio.sleep(15)
            assert vehicle.age(common.HighresImu) < 0.2

    fly(kind, scenario, prepare=reduce_telemetry)


def test_all_rates_are_requested_when_a_reboot_shows():
    async def scenario(peer):
        peer.send(boot_time(100))
        await peer.vehicle.set_message_rate(common.HighresImu, 10)
        await peer.vehicle.set_message_rate(common.Vibration, 1)
        for second in range(5):
            peer.send(common.HighresImu(), common.Vibration(), boot_time(100 + second))
            await asyncio.sleep(1)
        assert len(peer.requested_rates) == 2
        for second in range(6):  # they still come, at whatever rate is usual
            peer.send(common.HighresImu(), common.Vibration(), boot_time(1 + second))
            await asyncio.sleep(1)
        assert sorted(peer.requested_rates[2:]) == sorted(peer.requested_rates[:2])

    with_peer(scenario)


def test_a_rate_that_was_forgotten_silently_is_requested_again():
    async def scenario(peer):
        await peer.vehicle.set_message_rate(common.Attitude, 10)
        for _ in range(100):
            peer.send(common.Attitude())
            await asyncio.sleep(0.1)
        assert len(peer.requested_rates) == 1
        await asyncio.sleep(30)
        times = len(peer.requested_rates)
        assert 2 <= times <= 4
        await asyncio.sleep(600)
        assert times + 5 <= len(peer.requested_rates) <= times + 15, "again, but not for ever as often"

    with_peer(scenario)


def test_a_lost_vehicle_gets_no_requests():
    async def scenario(peer):
        await peer.vehicle.set_message_rate(common.Attitude, 10)
        requested_rates = []
        component = peer.vehicle.component
        object.__setattr__(
            component, "set_message_rate", lambda *arguments: requested_rates.append(arguments)
        )
        await peer.node.close()
        await asyncio.sleep(60)
        assert not peer.vehicle.alive
        assert requested_rates == []

    with_peer(scenario)


def test_a_rate_released_and_requested_again():
    async def scenario(peer):
        rates = peer.vehicle.telemetry.rates
        await peer.vehicle.set_message_rate(common.Attitude, 10)
        await peer.vehicle.set_message_rate(common.Attitude, None)
        await peer.vehicle.set_message_rate(common.Attitude, 20)
        await asyncio.sleep(1)
        assert rates.held == {common.Attitude: 20}
        assert peer.requested_rates[-1] == (ATTITUDE, 50_000)

    with_peer(scenario)


def test_a_refused_rate_is_not_requested_again_before_a_reboot():
    async def scenario(peer):
        peer.answer = RESULT.DENIED
        peer.send(boot_time(100))
        with pytest.raises(CommandDenied, match="DENIED"):
            await peer.vehicle.set_message_rate(common.Odometry, 5)
        assert peer.vehicle.telemetry.rates.denied(common.Odometry).code == RESULT.DENIED
        with pytest.raises(CommandDenied):
            await peer.vehicle.telemetry.rates.ask(common.Odometry)
        for second in range(60):
            peer.send(boot_time(100 + second))
            await asyncio.sleep(1)
        assert len(peer.requested_rates) == 1
        peer.answer = RESULT.ACCEPTED
        for second in range(10):
            peer.send(boot_time(1 + second))
            await asyncio.sleep(1)
        assert len(peer.requested_rates) >= 2
        assert peer.vehicle.telemetry.rates.denied(common.Odometry) is None

    with_peer(scenario)


def test_a_rate_can_be_changed_and_taken_back():
    async def scenario(peer):
        rates = peer.vehicle.telemetry.rates
        await peer.vehicle.set_message_rate(common.Attitude, 10)
        await peer.vehicle.set_message_rate(common.Attitude, 5)
        assert rates.held == {common.Attitude: 5}
        await peer.vehicle.set_message_rate(common.Attitude, None)
        await asyncio.sleep(1)
        assert rates.held == {}
        assert [interval for _, interval in peer.requested_rates] == [100_000, 200_000, 0]
        await asyncio.sleep(30)
        assert len(peer.requested_rates) == 3
        assert not rates._tasks, "nothing is left to watch"

    with_peer(scenario)


def test_a_rate_is_requested_once():
    async def scenario(peer):
        rates = peer.vehicle.telemetry.rates
        first, second = rates.hold(common.Attitude, 5), rates.hold(common.Attitude, 4)
        await asyncio.gather(*(rates.ask(common.Attitude) for _ in range(3)))
        assert len(peer.requested_rates) == 1
        rates.release(second)
        rates.release(second)
        await asyncio.sleep(1)
        assert len(peer.requested_rates) == 1, "the faster one is still wanted"
        rates.release(first)
        await asyncio.sleep(1)
        assert peer.requested_rates[1:] == [(ATTITUDE, 0)]
        await rates.ask(common.Attitude)  # no request holds it
        assert len(peer.requested_rates) == 2

    with_peer(scenario)


# At least so often


def test_a_message_that_arrives_often_enough_is_not_requested():
    async def scenario(peer):
        peer.send(common.Attitude())
        await asyncio.sleep(0.1)
        assert await peer.vehicle.telemetry.ensure(common.Attitude, 4) is True
        assert peer.requested_rates == []

    with_peer(scenario)


@pytest.mark.parametrize(("answer", "comes"), [(RESULT.ACCEPTED, True), (RESULT.UNSUPPORTED, False)])
def test_a_missing_message_is_requested_once(answer, comes):
    async def scenario(peer):
        peer.answer = answer
        for _ in range(3):
            assert await peer.vehicle.telemetry.ensure(common.Odometry, 4) is comes
        assert peer.requested_rates == [(ODOMETRY, 250_000)]

    with_peer(scenario, autopilot=PX4)


def test_closing_ends_its_tasks():
    async def scenario(peer):
        rates = peer.vehicle.telemetry.rates
        await peer.vehicle.set_message_rate(common.Attitude, 10)
        assert rates._tasks
        await peer.vehicle.telemetry.close()
        await asyncio.sleep(0)
        assert not rates._tasks

    with_peer(scenario)


def test_the_connections_end_ends_its_tasks():
    async def scenario(peer):
        rates = peer.vehicle.telemetry.rates
        await peer.vehicle.set_message_rate(common.Attitude, 10)
        await peer.vehicle.connection.close()
        await asyncio.sleep(0.1)
        assert not rates._tasks

    with_peer(scenario)
