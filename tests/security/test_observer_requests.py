"""Requests of clients that observe: one of many equal ones reaches a vehicle, and few per second."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.security.observer_requests import (
    LIST_INTERVAL,
    MAX_BURST,
    MAX_RATE,
    MAX_REQUESTS,
    REPEAT_INTERVAL,
    ObserverRequests,
)
from mavstack.security.roles import Role, RoleFilter
from mavstack.wire import Encoder, Parser

NOW = 1_790_000_000.0
LIST = common.ParamRequestList(target_system=1, target_component=1)
STATION = common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID)
AUTOPILOT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)


def named(number: int) -> common.ParamRequestRead:
    return common.ParamRequestRead(target_system=1, target_component=1, param_id=f"P{number}", param_index=-1)


def sent(encoder: Encoder, *messages) -> bytes:
    return b"".join(encoder.encode(message) for message in messages)


def names(data: bytes) -> list[str | None]:
    return [packet.name for packet in Parser(common).feed(data)]


def test_one_of_many_equal_requests_reaches_the_vehicle_in_its_interval():
    """Before: one observer forwarded 955,000 requests for all parameters in 6 s."""
    requests = ObserverRequests()
    passed = [NOW + step / 100 for step in range(4000) if requests.passes(LIST, NOW + step / 100)]
    assert passed == [NOW, NOW + LIST_INTERVAL]
    assert requests.held_back == 3998


def test_many_different_requests_pass_at_a_limited_rate():
    requests = ObserverRequests()
    passed = sum(requests.passes(named(step), NOW + step / 1000) for step in range(10_000))
    assert passed == pytest.approx(MAX_BURST + 10 * MAX_RATE, abs=2)
    assert len(requests._passed) <= MAX_REQUESTS


def test_a_request_passes_again_after_its_interval():
    requests = ObserverRequests()
    assert requests.passes(named(1), NOW)
    assert not requests.passes(named(1), NOW + REPEAT_INTERVAL - 0.1)
    assert requests.passes(named(1), NOW + REPEAT_INTERVAL)


@pytest.mark.parametrize("kind", [common.Ping, common.Timesync])
def test_echoes_are_one_request_whatever_their_numbers_are(kind):
    requests = ObserverRequests()
    messages = [common.Ping(seq=n) if kind is common.Ping else common.Timesync(ts1=n) for n in range(50)]
    assert [requests.passes(message, NOW) for message in messages].count(True) == 1


def test_the_observers_of_a_link_share_their_requests():
    requests = ObserverRequests()
    clients = [RoleFilter(Role.OBSERVE, requests) for _ in range(10)]
    passed = [client.filter(sent(Encoder(200 + n, 190), LIST), NOW) for n, client in enumerate(clients)]
    assert [names(each) for each in passed] == [["PARAM_REQUEST_LIST"], *([[]] * 9)]


def test_an_observer_has_the_ids_of_its_first_packet_and_no_heartbeat_of_an_autopilot():
    client, own, another = RoleFilter(Role.OBSERVE), Encoder(200, 190), Encoder(255, 190)
    assert names(client.filter(sent(own, STATION, AUTOPILOT), NOW)) == ["HEARTBEAT"]
    assert client.filter(sent(another, STATION, named(1)), NOW) == b""
    assert names(client.filter(sent(own, named(1)), NOW)) == ["PARAM_REQUEST_READ"]
    assert client.refused == {"ids of another": 3}


def test_the_first_packet_of_an_observer_is_no_heartbeat_of_an_autopilot():
    assert RoleFilter(Role.OBSERVE).filter(sent(Encoder(1, 1), AUTOPILOT), NOW) == b""


def test_operators_are_not_limited():
    client = RoleFilter(Role.OPERATE)
    assert len(names(client.filter(sent(Encoder(200, 190), *[LIST] * 100), NOW))) == 100
