"""The limit for a new peer of a UDP socket, whose address may be invented."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.links.probation import Probation
from mavstack.wire import Encoder

VEHICLE, STATION = Encoder(1, 1), Encoder(255, 190)
HELLO = common.Heartbeat(type=common.MavType.GCS)


def heartbeats(probation: Probation, count: int) -> int:
    """Send heartbeats of the vehicle; return the bytes that may be sent."""
    sent = [VEHICLE.encode(common.Heartbeat()) for _ in range(count)]
    return sum(len(data) for data in sent if probation.may_send(data))


def test_a_peer_that_answers_nothing_gets_three_times_what_it_sent() -> None:
    probation = Probation()
    assert heartbeats(probation, 100) == 0
    received = 0
    for _ in range(5):
        hello = STATION.encode(HELLO)
        probation.received(hello)
        received += len(hello)
    sent = heartbeats(probation, 1000)
    assert 2 * received < sent <= 3 * received
    assert not probation.is_over


def test_streams_leave_half_to_heartbeats_and_packets_with_a_target() -> None:
    probation = Probation()
    probation.received(bytes(100))
    streams = [VEHICLE.encode(common.Attitude(roll=1.0, yawspeed=1.0)) for _ in range(20)]
    sent = sum(len(data) for data in streams if probation.may_send(data))
    assert 100 < sent <= 150
    assert 100 < heartbeats(probation, 20) <= 300 - sent


def test_a_broadcast_request_is_sent_while_there_is_room() -> None:
    probation = Probation()
    probation.received(VEHICLE.encode(HELLO))
    assert probation.may_send(STATION.encode(common.Ping(seq=1)))


def test_an_answer_ends_the_limit_and_a_guess_before_anything_was_sent_does_not() -> None:
    request = common.ParamRequestList(target_system=1, target_component=1)
    probation = Probation()
    probation.received(STATION.encode(request))
    assert not probation.is_over
    assert heartbeats(probation, 1) > 0
    probation.received(STATION.encode(common.ParamRequestList(target_system=2)))
    assert not probation.is_over
    probation.received(STATION.encode(request))
    assert probation.is_over
    assert probation.may_send(VEHICLE.encode(common.Attitude()))


def test_an_acknowledgement_is_an_answer() -> None:
    probation = Probation()
    probation.received(bytes(100))
    assert probation.may_send(VEHICLE.encode(common.CommandLong(target_system=1, command=512)))
    probation.received(Encoder(1, 1).encode(common.CommandAck(command=512)))
    assert probation.is_over
