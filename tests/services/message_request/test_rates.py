from __future__ import annotations

from math import inf

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError, MessageTimeout
from mavstack.services import Service
from mavstack.services.addressing import message_ids
from mavstack.services.message_request import (
    DEFAULT,
    OFF,
    GetMessageInterval,
    Interval,
    SetMessageInterval,
    group_of,
    stream_groups,
)
from tests.services.message_request.harness import RequestHarness
from tests.services.network import START, VEHICLE


def test_an_interval_in_hertz_and_microseconds() -> None:
    assert Interval.hertz(50) == Interval(20_000)
    assert Interval.hertz(50).seconds == pytest.approx(0.02)
    assert Interval(500_000).rate == 2.0
    assert OFF.rate == DEFAULT.rate == 0.0


@pytest.mark.parametrize("rate", [0, -1, inf, float("nan")])
def test_a_rate_must_be_one(rate: float) -> None:
    with pytest.raises(InvalidArgumentError):
        Interval.hertz(rate)


def test_an_interval_must_fit() -> None:
    with pytest.raises(InvalidArgumentError):
        Interval(1 << 31)


def test_groups_are_disjoint() -> None:
    everything = [number for members in stream_groups().values() for number in members]
    assert len(everything) == len(set(everything))
    assert group_of(30) == common.MavDataStream.EXTRA1
    assert group_of(76) is None


def test_set_and_get() -> None:
    harness = RequestHarness()
    assert harness.run(GetMessageInterval(common.Attitude)).result() == Interval.hertz(4)
    assert harness.run(SetMessageInterval(common.Attitude, Interval.hertz(10))).result().whole_group is None
    assert harness.run(GetMessageInterval(common.Attitude)).result() == Interval.hertz(10)
    assert harness.run(SetMessageInterval(common.Attitude, OFF)).error is None
    assert harness.run(GetMessageInterval(30)).result() == OFF
    assert harness.run(SetMessageInterval(common.Attitude, DEFAULT)).error is None
    assert harness.run(GetMessageInterval(30)).result() == Interval.hertz(4)
    assert harness.run(GetMessageInterval(common.GpsRawInt)).result() == DEFAULT


def test_a_refusal_is_a_typed_error() -> None:
    harness = RequestHarness()
    operation = harness.run(SetMessageInterval(common.GpsRawInt, Interval.hertz(1)))
    assert isinstance(operation.error, CommandDenied)


class OldStreams(Service):
    """An autopilot that knows data streams only; `answer` says how it shows that it understood."""

    handles = message_ids(common.RequestDataStream)

    def __init__(self, answer: type | None) -> None:
        super().__init__(VEHICLE)
        self.answer = answer
        self.requests = []

    def receive(self, packet, now: float) -> None:
        message = packet.message
        self.requests.append((int(message.req_stream_id), message.req_message_rate, message.start_stop))
        if self.answer is common.DataStream:
            on = message.start_stop
            self.send(common.DataStream(stream_id=message.req_stream_id, message_rate=4, on_off=on))
        elif self.answer:
            self.send(self.answer())


@pytest.mark.parametrize("answer", [common.Attitude, common.DataStream])
def test_who_knows_no_intervals_is_requested_the_group(answer: type) -> None:
    harness = RequestHarness(old=True)
    streams = harness.vehicle.engine.add(OldStreams(answer))
    outcome = harness.run(SetMessageInterval(common.Attitude, Interval.hertz(4))).result()
    assert outcome.whole_group == common.MavDataStream.EXTRA1
    assert streams.requests == [(10, 4, 1)]


def test_a_group_that_stays_silent_is_a_typed_error() -> None:
    harness = RequestHarness(old=True)
    streams = harness.vehicle.engine.add(OldStreams(None))
    operation = harness.run(SetMessageInterval(common.Attitude, Interval.hertz(4)))
    assert isinstance(operation.error, MessageTimeout)
    assert len(streams.requests) == 5


def test_a_group_is_turned_off_more_than_once() -> None:
    harness = RequestHarness(old=True)
    streams = harness.vehicle.engine.add(OldStreams(None))
    assert harness.run(SetMessageInterval(common.Attitude, OFF)).error is None
    assert [request[2] for request in streams.requests] == [0, 0, 0]


@pytest.mark.parametrize(("kind", "interval"), [(common.Attitude, DEFAULT), (common.Ping, Interval(9))])
def test_rates_that_streams_cannot_express_stay_refused(kind: type, interval: Interval) -> None:
    harness = RequestHarness(old=True)
    operation = harness.run(SetMessageInterval(kind, interval))
    assert operation.error.code == common.MavResult.UNSUPPORTED
    assert harness.network.now - START < 10
