from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError, MessageTimeout
from mavstack.services.command import Command, CommandClient, CommandOperation
from mavstack.services.message_request import RequestMessage
from tests.services.message_request.harness import RequestHarness
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import feed_random_messages, packet_of, sent_by

REQUEST = common.MavCmd.REQUEST_MESSAGE


def ack(result: int, command: int = REQUEST) -> common.CommandAck:
    return common.CommandAck(
        command=command, result=result, target_system=GROUND.system, target_component=GROUND.component
    )


def asked(params: tuple[float, ...] = (), **kwargs) -> tuple[CommandClient, RequestMessage]:
    client = CommandClient(GROUND, VEHICLE)
    return client, client.begin(RequestMessage(common.HomePosition, params, **kwargs), START)


def test_a_message_by_its_class_and_by_its_id() -> None:
    harness = RequestHarness()
    for kind in (common.HomePosition, 242):
        assert harness.run(RequestMessage(kind)).result() == common.HomePosition(altitude=584_000)
    assert harness.received_commands() == [REQUEST, REQUEST]


def test_request_message_is_tried_before_the_older_command() -> None:
    client, _ = asked((3.0,))
    (command,) = sent_by(client)
    assert (command.command, command.param1, command.param2) == (REQUEST, 242.0, 3.0)


def test_the_message_may_come_before_the_ack() -> None:
    client, operation = asked()
    sent_by(client)
    client.receive(packet_of(common.HomePosition(altitude=7)), START + 0.1)
    assert operation.result().altitude == 7


def test_the_ack_may_be_lost() -> None:
    client, operation = asked()
    sent_by(client)
    client.receive(packet_of(common.HomePosition()), START + 0.1)
    assert operation.done
    client.handle_timeout(START + 60)
    assert sent_by(client, START + 60) == [], "what has its message is not asked for again"
    assert not client.busy


def test_an_ack_that_comes_after_its_message_is_not_the_next_requests() -> None:
    client, first = asked()
    sent_by(client)
    client.receive(packet_of(common.HomePosition()), START + 0.1)
    second = client.begin(RequestMessage(common.VfrHud), START + 0.1)
    assert first.done
    assert sent_by(client) == [], "the second waits for the first one's ack"
    client.receive(packet_of(ack(common.MavResult.DENIED)), START + 0.2)
    assert not second.done
    (command,) = sent_by(client)
    assert command.param1 == 74.0


def test_a_denied_request_is_a_typed_error() -> None:
    client = CommandClient(GROUND, VEHICLE)
    operation = client.begin(RequestMessage(common.VfrHud), START)
    client.receive(packet_of(ack(common.MavResult.DENIED)), START + 0.1)
    assert isinstance(operation.error, CommandDenied)
    assert operation.error.code == common.MavResult.DENIED
    assert str(operation.error) == "requesting VFR_HUD from 1/1 failed: DENIED"


@pytest.mark.parametrize("result", [common.MavResult.UNSUPPORTED, common.MavResult.FAILED])
def test_the_older_command_is_the_second_choice(result: int) -> None:
    client, operation = asked()
    sent_by(client)
    client.receive(packet_of(ack(result)), START + 0.1)
    (command,) = sent_by(client)
    assert command.command == common.MavCmd.GET_HOME_POSITION
    client.receive(packet_of(ack(0, common.MavCmd.GET_HOME_POSITION)), START + 0.2)
    assert not operation.done
    client.receive(packet_of(common.HomePosition()), START + 0.3)
    assert operation.error is None


def test_if_both_are_refused_the_error_has_the_more_specific_result() -> None:
    client, operation = asked()
    client.receive(packet_of(ack(common.MavResult.FAILED)), START + 0.1)
    client.receive(packet_of(ack(common.MavResult.UNSUPPORTED, common.MavCmd.GET_HOME_POSITION)), START + 0.2)
    assert operation.error.code == common.MavResult.FAILED


@pytest.mark.parametrize(
    ("kind", "params", "command"),
    [
        (common.AutopilotVersion, (), Command(common.MavCmd.REQUEST_AUTOPILOT_CAPABILITIES, 1)),
        (common.ProtocolVersion, (), Command(common.MavCmd.REQUEST_PROTOCOL_VERSION, 1)),
        (common.HomePosition, (), Command(common.MavCmd.GET_HOME_POSITION)),
        (common.StorageInformation, (2.0,), Command(common.MavCmd.REQUEST_STORAGE_INFORMATION, 2, 1)),
        (common.MessageInterval, (30.0,), Command(common.MavCmd.GET_MESSAGE_INTERVAL, 30)),
    ],
)
def test_older_commands_and_their_params(kind: type, params: tuple[float, ...], command: Command) -> None:
    harness = RequestHarness(old=True)
    got = []
    harness.commands.support(command.command, lambda request: got.append(request.command) or 0)
    harness.begin(RequestMessage(kind, params))
    assert harness.network.run(lambda: bool(got), timeout=10)
    assert got == [command]


def test_accepted_but_not_sent_is_requested_again_and_then_times_out() -> None:
    harness = RequestHarness(old=True)
    harness.commands.support(REQUEST, lambda _: common.MavResult.ACCEPTED)
    operation = harness.run(RequestMessage(common.VfrHud))
    assert isinstance(operation.error, MessageTimeout)
    assert "did not arrive" in str(operation.error)
    assert operation.error.attempts == 4


def test_accepted_but_not_sent_then_the_older_command_is_tried() -> None:
    harness = RequestHarness(old=True)
    harness.commands.support(REQUEST, lambda _: common.MavResult.ACCEPTED)
    harness.begin(RequestMessage(common.HomePosition))
    harness.run_for(60)
    assert common.MavCmd.GET_HOME_POSITION in harness.received_commands()


def test_silence_is_a_typed_error() -> None:
    client, operation = asked()
    now = START
    while not operation.done:
        now = client.next_timeout()
        client.handle_timeout(now)
    assert isinstance(operation.error, MessageTimeout)
    assert now - START < 60


def test_only_the_instance_that_was_requested() -> None:
    client = CommandClient(GROUND, VEHICLE)
    wanted = RequestMessage(common.StorageInformation, (2,), match=lambda message: message.storage_id == 2)
    client.begin(wanted, START)
    client.receive(packet_of(common.StorageInformation(storage_id=1)), START)
    assert not wanted.done
    client.receive(packet_of(common.StorageInformation(storage_id=2)), START)
    assert wanted.result().storage_id == 2


def test_cancelling_leaves_nothing_running() -> None:
    client, operation = asked()
    client.cancel(operation, START + 0.1)
    now = START
    while client.busy:
        now = client.next_timeout()
        client.handle_timeout(now)
    sent = sent_by(client, now)
    assert not any(isinstance(message, common.CommandCancel) for message in sent)
    assert now - START < 10


def test_many_at_once() -> None:
    harness = RequestHarness()
    operations = [harness.begin(RequestMessage(common.HomePosition)) for _ in range(5)]
    operations.append(harness.begin(RequestMessage(common.VfrHud)))
    operations.append(harness.begin(CommandOperation(Command(common.MavCmd.DO_SET_SERVO))))
    assert harness.network.run(lambda: all(operation.done for operation in operations), timeout=60)
    assert all(operation.error is None for operation in operations[:5])
    assert [operation.error.code for operation in operations[5:]] == [4, 3]


def test_too_many_params_are_our_own_mistake() -> None:
    with pytest.raises(InvalidArgumentError, match="2 to 6"):
        RequestMessage(common.Attitude, (1, 2, 3, 4, 5, 6))


@pytest.mark.parametrize("seed", range(20))
def test_garbage_never_raises(seed: int) -> None:
    client, _ = asked((1.0,))
    feed_random_messages(client, [common.CommandAck, common.HomePosition], seed)
