"""Members that tell each other where they are, and steer by what they receive."""

from __future__ import annotations

import asyncio
from importlib.resources import files

import numpy as np
import pytest

from mavstack.cli.main import main
from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.links import Impairment, MemoryNetwork, impair
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.sim.virtual import run_virtually
from mavstack.swarm.barrier import Barrier, BarrierState
from mavstack.swarm.consensus import Neighbour, steer
from mavstack.swarm.exchange import NEIGHBOUR_TIMEOUT, Exchange, Intent, swarm_dialect
from mavstack.swarm.formations import Formation

FRAME = LocalFrame(47.4, 8.5, 450.0)
STEP = 0.2


def neighbour(position=(10.0, -20.0, 30.0), velocity=(1.0, -2.0, 0.5), slot=(5.0, -5.0, 0.0)):
    return Neighbour(np.array(position), np.array(velocity), np.array(slot))


def test_a_state_arrives_and_is_carried_on_until_it_is_too_old():
    mine, its = Exchange(FRAME, 1), Exchange(FRAME, 2)
    message = its.state_message(neighbour(), 1000)
    assert mine.receive(2, message, 100.0)
    found = mine.members(100.5)[2]
    assert found.position == pytest.approx([10.5, -21.0, 30.25], abs=0.02)
    assert found.slot == pytest.approx([5.0, -5.0, 0.0])
    assert mine.members(100.0 + NEIGHBOUR_TIMEOUT + 0.1) == {}


def test_an_intent_counts_down():
    mine, its = Exchange(FRAME, 1), Exchange(FRAME, 2)
    intent = Intent(np.array((1.0, 2.0, 3.0)), 12.0, 4)
    assert mine.receive(2, its.intent_message(intent, 0), 10.0)
    found = mine.intents(12.0)[2]
    assert (found.arrival, found.phase) == (10.0, 4)
    assert found.place == pytest.approx([1.0, 2.0, 3.0], abs=0.02)


@pytest.mark.parametrize(
    ("phase", "arrival", "passed"),
    [(4, 0.0, True), (4, 0.01, False), (4, 1.0, False), (3, 0.0, False), (5, 9.0, True), (131, 9.0, True)],
)
def test_a_phase_is_over_for_a_member_that_reported_its_arrival_or_is_in_a_later_one(phase, arrival, passed):
    mine, its, barrier = Exchange(FRAME, 1), Exchange(FRAME, 2), Barrier([2], timeout=None, now=0.0)
    assert mine.receive(2, its.intent_message(Intent(np.zeros(3), arrival, phase), 0), 10.0)
    mine.report_arrivals(barrier, 4, 12.0)
    assert barrier.state(12.0) is (BarrierState.OPEN if passed else BarrierState.WAITING)


def test_the_phase_after_the_last_number_is_later():
    assert Intent(np.zeros(3), 9.0, 0).has_passed(255)
    assert not Intent(np.zeros(3), 0.0, 255).has_passed(0)


def test_own_messages_and_those_of_other_swarms_are_ignored():
    mine = Exchange(FRAME, 1, swarm=1)
    assert not mine.receive(1, mine.state_message(neighbour(), 0), 0.0)
    assert not mine.receive(2, Exchange(FRAME, 2, swarm=2).state_message(neighbour(), 0), 0.0)
    with pytest.raises(InvalidArgumentError, match="swarm must be 0 to 255"):
        Exchange(FRAME, 1, swarm=256)
    with pytest.raises(InvalidArgumentError, match="must be finite"):
        mine.state_message(neighbour(position=(np.nan, 0.0, 0.0)), 0)


def test_ids_are_above_those_of_mavlink_1_and_the_dialect_compiles(tmp_path, capsys):
    dialect = swarm_dialect()
    assert [dialect[name].definition.id for name in ("SWARM_STATE", "SWARM_INTENT")] == [53000, 53001]
    source = tmp_path / "swarm.xml"
    source.write_bytes(files("mavstack.swarm").joinpath("swarm.xml").read_bytes())
    assert main(["gen", "c", str(source), "--output", str(tmp_path / "c")]) == 0
    assert list((tmp_path / "c").rglob("*swarm*"))
    capsys.readouterr()


async def member(network, index, slots, track, keys, conditions):
    """A companion computer: a point that flies as consensus steers it, with a node."""
    random = np.random.default_rng(index)
    place, velocity = random.uniform(-60, 60, 3) * (1, 1, 0) + (0, 0, 20), np.zeros(3)
    exchange = Exchange(FRAME, index + 1)
    link = impair(network.link(), Impairment(**conditions))
    async with (
        Node(link, dialect=swarm_dialect(), system=index + 1, signing=keys[index]) as node,
        node.packets(queue=200) as packets,
    ):
        reading = asyncio.create_task(read(packets, exchange, node))
        for step in range(round(60 / STEP)):
            own = Neighbour(place, velocity, slots[index])
            node.send(exchange.state_message(own, round(1000 * STEP * step)))
            velocity = steer(own, exchange.neighbours(node.now()), np.array((1.0, 0.0, 0.0)))
            place = place + STEP * velocity
            await asyncio.sleep(STEP)
        track[index] = place, len(exchange.neighbours(node.now()))
        reading.cancel()


async def phases(network, index, ways, log, conditions):
    """A companion computer whose vehicle flies ways of some seconds, with a barrier after each."""
    exchange, system = Exchange(FRAME, index + 1), index + 1
    link = impair(network.link(), Impairment(**conditions))
    async with (
        Node(link, dialect=swarm_dialect(), system=system) as node,
        node.packets(queue=200) as packets,
    ):
        reading = asyncio.create_task(read(packets, exchange, node))
        for phase, seconds in enumerate(ways[index]):
            begin = node.now()
            log.append((begin, "begins", phase, system))
            barrier = Barrier(range(1, len(ways) + 1), timeout=30.0, now=begin)
            while barrier.state(node.now()) is BarrierState.WAITING:
                left = max(seconds - (node.now() - begin), 0.0)
                if not left and system in barrier.missing:
                    log.append((node.now(), "ends", phase, system))
                    barrier.arrive(system)
                node.send(exchange.intent_message(Intent(np.zeros(3), left, phase), 0))
                exchange.report_arrivals(barrier, phase, node.now())
                await asyncio.sleep(STEP)
            log.append((node.now(), str(barrier.state(node.now())), phase, *barrier.missing))
        reading.cancel()


def flown_in_phases(ways, **conditions):
    async def scenario():
        network, log = MemoryNetwork(), []
        async with asyncio.TaskGroup() as group:
            for index in range(len(ways)):
                group.create_task(phases(network, index, ways, log, conditions))
        return log

    return run_virtually(scenario())


def test_no_member_begins_a_phase_before_all_have_ended_the_one_before():
    log = flown_in_phases([(2.0, 9.0, 1.0), (8.0, 1.0, 2.0), (5.0, 3.0, 6.0)], loss=0.2, latency=0.2)
    for phase in (1, 2):
        ends = [time for time, event, number, *_ in log if event == "ends" and number == phase - 1]
        begins = [time for time, event, number, *_ in log if event == "begins" and number == phase]
        assert len(ends) == len(begins) == 3
        assert max(ends) < min(begins)
        assert max(begins) < max(ends) + 2.0


def test_a_member_that_does_not_arrive_breaks_the_barrier_of_the_others():
    log = flown_in_phases([(2.0,), (3.0,), (60.0,)])
    broken = [(phase, *missing) for _, event, phase, *missing in log if event == "broken"]
    assert broken[:2] == [(0, 3), (0, 3)]


async def read(packets, exchange, node):
    async for packet in packets:
        if packet.message is not None:
            exchange.receive(packet.system, packet.message, node.now())


def flown(keys, count=5, **conditions):
    async def scenario():
        network, track = MemoryNetwork(), {}
        slots = Formation("wedge", spacing=10).offsets(count)
        async with asyncio.TaskGroup() as group:
            for index in range(count):
                group.create_task(member(network, index, slots, track, keys, conditions))
        places = np.array([track[index][0] for index in range(count)]) - slots
        return places, [track[index][1] for index in range(count)]

    return run_virtually(scenario())


def test_members_form_up_by_what_they_receive_over_a_bad_link():
    key = SigningKey(bytes(range(32)))
    places, heard = flown([key] * 5, loss=0.2, latency=0.2)
    assert heard == [4] * 5
    assert np.abs(places - places.mean(axis=0)).max() < 1.0


def test_a_member_with_another_key_is_not_heard():
    keys = [SigningKey(bytes(range(32)))] * 3 + [SigningKey(bytes(32))]
    _, heard = flown(keys, count=4)
    assert heard == [2, 2, 2, 0]
