from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.links import Impairment
from mavstack.services.timesync import OffsetEstimator, TimeOffsetChanged, TimesyncClient, TimesyncServer
from tests.services.network import GROUND, START, VEHICLE, Network
from tests.services.single_service import feed_random_messages, packet_of, sent_by

if TYPE_CHECKING:
    from mavstack.services import Address

BOOTED = START - 1234.5


def since_boot(now: float) -> int:
    return round((now - BOOTED) * 1e9)


def joined(impairment: Impairment | None = None, clock=since_boot):
    network = Network()
    ground = network.node(GROUND)
    vehicle = network.node(VEHICLE, lambda engine: engine.add(TimesyncServer(VEHICLE, clock)))
    network.connect(ground, vehicle, impairment)
    return network, ground, ground.engine.add(TimesyncClient(GROUND, VEHICLE))


def request(client: TimesyncClient, now: float = START) -> common.Timesync:
    client.handle_timeout(now)
    (message,) = sent_by(client, now)
    return message


def answer(asked: common.Timesync, tc1: int, target: Address = GROUND) -> common.Timesync:
    return common.Timesync(
        tc1=tc1, ts1=asked.ts1, target_system=target.system, target_component=target.component
    )


def test_the_offset_to_a_clock_since_boot() -> None:
    network, _, client = joined(Impairment(latency=0.02, jitter=0.01))
    network.run(lambda: client.estimate is not None and client.estimate.samples > 10)
    assert client.estimate.converged
    assert client.estimate.offset == pytest.approx(-BOOTED, abs=client.estimate.uncertainty)
    assert client.estimate.round_trip == pytest.approx(0.04, abs=0.021)
    assert client.addressed


def test_times_are_translated() -> None:
    client = TimesyncClient(GROUND, VEHICLE)
    assert client.to_remote(5) is client.to_local(5) is None
    asked = request(client)
    client.receive(packet_of(answer(asked, asked.ts1 + 7_000_000_000)), START)
    assert client.to_remote(0) == 7_000_000_000
    assert client.to_local(7_000_000_000) == 0


def test_a_request_has_tc1_0_and_is_addressed() -> None:
    asked = request(TimesyncClient(GROUND, VEHICLE))
    assert asked.tc1 == 0
    assert asked.ts1 != 0
    assert (asked.target_system, asked.target_component) == VEHICLE


def test_the_answer_is_addressed_to_who_requested() -> None:
    server = TimesyncServer(VEHICLE, lambda _: 77)
    server.receive(packet_of(common.Timesync(tc1=0, ts1=5), GROUND), START)
    (outgoing,) = server.messages_to_send(START)
    assert outgoing.message == common.Timesync(tc1=77, ts1=5, target_system=255, target_component=190)
    assert outgoing.target == GROUND


def test_an_answer_is_never_answered() -> None:
    server = TimesyncServer(VEHICLE)
    server.receive(packet_of(common.Timesync(tc1=-5, ts1=5), GROUND), START)
    assert sent_by(server) == []


def test_a_clock_at_zero_does_not_make_a_request_of_the_answer() -> None:
    server = TimesyncServer(VEHICLE, lambda _: 0)
    server.receive(packet_of(common.Timesync(tc1=0, ts1=5), GROUND), START)
    assert sent_by(server)[0].tc1 != 0


def test_a_peer_of_the_first_version_answers_all() -> None:
    client = TimesyncClient(GROUND, VEHICLE)
    asked = request(client)
    client.receive(packet_of(common.Timesync(tc1=9, ts1=asked.ts1 + 1)), START)
    assert client.estimate is None, "the answer to somebody else"
    client.receive(packet_of(common.Timesync(tc1=9, ts1=asked.ts1)), START)
    assert client.estimate is not None
    assert client.addressed is False


def test_an_answer_counts_once() -> None:
    client = TimesyncClient(GROUND, VEHICLE)
    asked = request(client)
    for delay in (0.1, 0.2):
        client.receive(packet_of(answer(asked, 9)), START + delay)
    assert client.estimate.samples == 1


def test_who_never_answers_is_requested_rarely_and_remembered_boundedly() -> None:
    client = TimesyncClient(GROUND, VEHICLE)
    times = []
    while not times or times[-1] < START + 1000:
        now = max(client.next_timeout(), START)
        request(client, now)
        times.append(now)
    assert times[-1] - times[-2] == pytest.approx(5.0)
    assert len(client._outstanding) <= 16


def test_an_answer_after_a_long_round_trip_is_ignored() -> None:
    client = TimesyncClient(GROUND, VEHICLE)
    asked = request(client)
    client.receive(packet_of(answer(asked, 9)), START + 6)
    assert client.estimate is None


def test_one_slow_exchange_hardly_matters() -> None:
    estimator = OffsetEstimator()
    for _ in range(10):
        estimator.add(100.0, 0.02)
    estimator.add(100.9, 2.0)  # a delay of two seconds, one way only
    assert estimator.estimate.offset == pytest.approx(100.0)


def test_one_impossible_sample_does_not_move_the_estimate_but_several_do() -> None:
    estimator = OffsetEstimator()
    for _ in range(10):
        estimator.add(100.0, 0.02)
    assert [estimator.add(500.0, 0.02) for _ in range(2)] == [False, False]
    assert estimator.estimate.offset == 100.0
    assert estimator.add(500.0, 0.02)
    assert estimator.estimate.offset == 500.0
    assert not estimator.estimate.converged


def test_a_vehicle_that_restarts_is_noticed() -> None:
    offset = [BOOTED]
    network, ground, client = joined(Impairment(latency=0.01), lambda now: round((now - offset[0]) * 1e9))
    network.run(lambda: client.estimate is not None and client.estimate.converged)
    offset[0] = network.now
    network.run(lambda: any(event.jumped for event in ground.events_of(TimeOffsetChanged)), timeout=60)
    assert client.estimate.offset == pytest.approx(-offset[0], abs=0.02)


def test_a_drifting_clock_is_followed() -> None:
    network, ground, client = joined(
        Impairment(latency=0.01), lambda now: round((now + (now - START) * 50e-6) * 1e9)
    )
    network.run(timeout=3600)
    assert not any(event.jumped for event in ground.events_of(TimeOffsetChanged))
    assert client.estimate.offset == pytest.approx((network.now - START) * 50e-6, abs=0.01)


@pytest.mark.parametrize("seed", range(20))
def test_garbage_never_raises(seed: int) -> None:
    for service in (TimesyncClient(GROUND, VEHICLE), TimesyncServer(VEHICLE)):
        feed_random_messages(service, [common.Timesync], seed)
