from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, RemoteTimeout
from mavstack.links import Impairment
from mavstack.services import BROADCAST, Address
from mavstack.services.ping import PingClient, PingServer, PingStatistics
from tests.services.network import GROUND, START, VEHICLE, Network
from tests.services.single_service import feed_random_messages, packet_of, sent_by


def answer_to(ping: common.Ping, target: Address = GROUND) -> common.Ping:
    return ping.replace(target_system=target.system, target_component=target.component)


def test_round_trips_are_measured() -> None:
    network = Network()
    ground, vehicle = network.node(GROUND), network.node(VEHICLE, lambda e: e.add(PingServer(VEHICLE)))
    network.connect(ground, vehicle, Impairment(latency=0.04))
    client = ground.engine.add(PingClient(GROUND, VEHICLE))
    operation = client.ping(network.now, count=3)
    ground.engine.touch(client)
    network.run(lambda: operation.done)
    statistics = operation.result()
    assert (statistics.sent, statistics.received, statistics.loss) == (3, 3, 0.0)
    assert statistics.mean == pytest.approx(0.08, abs=1e-3)


def test_a_request_has_no_targets_and_goes_to_one_component() -> None:
    client = PingClient(GROUND, VEHICLE)
    client.ping(START, count=1)
    (outgoing,) = client.messages_to_send(START)
    assert (outgoing.message.target_system, outgoing.message.target_component) == (0, 0)
    assert outgoing.target == VEHICLE != BROADCAST


def test_the_server_sends_the_request_back_to_its_sender() -> None:
    server = PingServer(VEHICLE)
    server.receive(packet_of(common.Ping(time_usec=5, seq=6), GROUND), START)
    (outgoing,) = server.messages_to_send(START)
    assert outgoing.message == common.Ping(time_usec=5, seq=6, target_system=255, target_component=190)
    assert outgoing.target == GROUND


def test_an_answer_is_never_answered() -> None:
    server = PingServer(VEHICLE)
    for targets in ((1, 1), (1, 0), (0, 1)):
        ping = common.Ping(seq=1, target_system=targets[0], target_component=targets[1])
        server.receive(packet_of(ping, GROUND), START)
    assert sent_by(server) == []


def test_only_the_answer_to_our_own_ping_counts() -> None:
    client = PingClient(GROUND, VEHICLE)
    operation = client.ping(START, count=1)
    (ping,) = sent_by(client)
    client.receive(packet_of(ping), START + 0.1)  # another client's request
    client.receive(packet_of(answer_to(ping.replace(seq=ping.seq + 1))), START + 0.1)
    client.receive(packet_of(answer_to(ping.replace(time_usec=1))), START + 0.1)
    client.receive(packet_of(answer_to(ping), Address(2, 1)), START + 0.1)
    assert not operation.done
    client.receive(packet_of(answer_to(ping)), START + 0.25)
    assert operation.result().round_trips == pytest.approx((0.25,), abs=1e-6)


def test_an_answer_counts_once_and_copies_are_counted() -> None:
    client = PingClient(GROUND, VEHICLE)
    operation = client.ping(START, count=2)
    (first,) = sent_by(client)
    client.receive(packet_of(answer_to(first)), START + 0.1)
    client.receive(packet_of(answer_to(first)), START + 0.2)
    client.handle_timeout(START + 1)
    (second,) = sent_by(client)
    assert second.seq == first.seq + 1
    client.receive(packet_of(answer_to(second)), START + 1.5)
    assert operation.result() == PingStatistics(2, operation.result().round_trips, duplicates=1)
    assert operation.result().received == 2


def test_a_lost_ping_is_not_late() -> None:
    client = PingClient(GROUND, VEHICLE)
    operation = client.ping(START, count=2, wait=2)
    (first,) = sent_by(client)
    client.handle_timeout(START + 1)
    client.receive(packet_of(answer_to(first)), START + 2.9)
    assert not operation.done
    client.handle_timeout(START + 3)
    assert operation.result().loss == 0.5
    assert operation.result().maximum == pytest.approx(2.9)


def test_numbers_wrap() -> None:
    client = PingClient(GROUND, VEHICLE)
    client._next = 0xFFFFFFFF
    client.ping(START, count=2)
    (first,) = sent_by(client)
    client.handle_timeout(START + 1)
    (second,) = sent_by(client)
    assert (first.seq, second.seq) == (0xFFFFFFFF, 0)


def test_no_client_answers() -> None:
    client = PingClient(GROUND, VEHICLE)
    operation = client.ping(START, count=3)
    now = START
    while not operation.done:
        now = client.next_timeout()
        client.handle_timeout(now)
    assert isinstance(operation.error, RemoteTimeout)
    assert (operation.error.attempts, now) == (3, START + 4)


@pytest.mark.parametrize("wrong", [{"count": 0}, {"interval": 0}, {"wait": 0}, {"enough": 9}])
def test_our_own_mistakes_raise(wrong: dict[str, float]) -> None:
    with pytest.raises(InvalidArgumentError):
        PingClient(GROUND, VEHICLE).ping(START, **wrong)


@pytest.mark.parametrize("seed", range(20))
def test_garbage_never_raises(seed: int) -> None:
    client = PingClient(GROUND, VEHICLE)
    client.ping(START)
    for service in (client, PingServer(VEHICLE)):
        feed_random_messages(service, [common.Ping], seed)
