"""The vehicle's side of arm authorisation against answers of an authoriser."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.arm_authorization import (
    ArmApproval,
    ArmAuthorizationAnswered,
    ArmAuthorizationClient,
    ArmRefusal,
    send_answer,
)
from mavstack.services.command import CommandServer, CommandStarted
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, feed_random_messages, run_timers, sent_by

COMMAND = common.MavCmd.ARM_AUTHORIZATION_REQUEST
ANSWERS = st.one_of(
    st.builds(ArmApproval, st.integers(1, 65535)),
    st.builds(ArmRefusal, st.integers(0, 255), st.integers(0, 1000), st.booleans()),
)


def asking(timeout: float = 1.0) -> ArmAuthorizationClient:
    client = ArmAuthorizationClient(VEHICLE)
    client.request(GROUND.system, START, timeout=timeout)
    return client


@given(ANSWERS)
def test_answers_reach_the_vehicle(answer):
    client, server = asking(), CommandServer(GROUND)
    server.support(COMMAND, lambda request: None)
    ((_, request), *_) = run_timers(client, START)
    assert (request.target_system, request.param1) == (GROUND.system, VEHICLE.system)
    deliver(server, request, VEHICLE, START)
    (started,) = [event for event in server.events() if isinstance(event, CommandStarted)]
    send_answer(server, started.request, answer)
    for ack in sent_by(server):
        deliver(client, ack, GROUND, START)
    assert client.events() == [ArmAuthorizationAnswered(answer)]
    assert not client.is_waiting


def test_no_answer():
    client = asking()
    sent = run_timers(client, START + 5)
    assert [message.confirmation for _, message in sent] == [0, 1, 2, 3]
    assert client.events() == [ArmAuthorizationAnswered(None)]


def test_an_answer_in_progress_stops_the_repetition():
    client = asking()
    run_timers(client, START)
    ack = common.CommandAck(command=COMMAND, result=common.MavResult.IN_PROGRESS)
    deliver(client, ack, GROUND, START)
    assert run_timers(client, START + 0.9) == []
    assert client.is_waiting


def test_answers_of_others_do_not_count():
    client = asking()
    ack = common.CommandAck(command=COMMAND, result=0, result_param2=60)
    deliver(client, ack, VEHICLE, START)
    deliver(client, ack.replace(command=common.MavCmd.NAV_LAND), GROUND, START)
    assert client.events() == []


def test_random_messages():
    feed_random_messages(asking(100), [common.CommandAck], seed=3)


@pytest.mark.parametrize("make", [lambda: ArmApproval(0), lambda: ArmRefusal(256), lambda: ArmRefusal(0, -1)])
def test_values_out_of_range(make):
    with pytest.raises(InvalidArgumentError):
        make()
