"""Pitfalls of the command protocol, one test each, and the tables of client and server."""

from __future__ import annotations

from math import isnan, nan

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, InvalidArgumentError, RemoteCancelled
from mavstack.services import Address
from mavstack.services.command import Command, CommandCancelRequested, CommandClient, CommandServer
from mavstack.services.command.client import ATTEMPTS, PROGRESS_TIMEOUT, SLOW_TIMEOUT
from mavstack.wire import Packet, encode
from tests.services.network import GROUND, START, VEHICLE

SERVO, WINCH = common.MavCmd.DO_SET_SERVO, common.MavCmd.DO_WINCH
REPOSITION = common.MavCmd.DO_REPOSITION
ARM = common.MavCmd.COMPONENT_ARM_DISARM
RESULT = common.MavResult


def packet(message, source: Address = VEHICLE, sequence: int = 0) -> Packet:
    raw = encode(message, system=source.system, component=source.component, sequence=sequence)
    return Packet(raw, common)


def ack(command, result=RESULT.ACCEPTED, **fields) -> Packet:
    return packet(common.CommandAck(command=command, result=result, **fields))


def sent(service, now: float = START) -> list:
    return [outgoing.message for outgoing in service.messages_to_send(now)]


@pytest.fixture
def client() -> CommandClient:
    return CommandClient(GROUND, VEHICLE)


@pytest.fixture
def server() -> CommandServer:
    server = CommandServer(VEHICLE)
    server.support(SERVO, lambda _: RESULT.ACCEPTED)
    server.support(WINCH, lambda _: None)
    return server


def command_long(command, confirmation=0, target=VEHICLE, **params):
    return common.CommandLong(
        target_system=target.system,
        target_component=target.component,
        command=command,
        confirmation=confirmation,
        **params,
    )


# The client


def test_command_long_repeats_with_a_higher_confirmation(client) -> None:
    operation = client.command(Command(SERVO), START)
    confirmations = []
    while not operation.done:
        confirmations += [
            message.confirmation for message in sent(client) if hasattr(message, "confirmation")
        ]
        client.handle_timeout(operation.next_timeout())
    assert confirmations == list(range(ATTEMPTS))
    with pytest.raises(
        CommandTimeout, match=f"DO_SET_SERVO on 1/1 failed after {ATTEMPTS} attempts: no answer"
    ):
        operation.result()


def test_a_command_that_is_executed_before_its_answer_is_not_repeated_after_a_round_trip(client) -> None:
    for _ in range(5):  # a fast link
        operation = client.command(Command(SERVO), START)
        client.receive(ack(SERVO), START + 0.01)
    calibration = common.MavCmd.PREFLIGHT_CALIBRATION
    operation = client.command(Command(calibration, param1=1), START)
    assert operation.next_timeout() == START + SLOW_TIMEOUT
    client.receive(ack(calibration), START + 2.0)
    operation = client.command(Command(SERVO), START)
    assert operation.next_timeout() < START + 0.5  # the calibration was no sample of the round trip


def test_command_int_repeats_as_it_is(client) -> None:
    operation = client.command(Command(REPOSITION, param5=47.1, param6=8.5, frame=6), START)
    first = sent(client)
    client.handle_timeout(operation.next_timeout())
    assert first == sent(client)
    assert (first[0].x, first[0].y) == (471000000, 85000000)


def test_an_ack_is_matched_by_command_and_source(client) -> None:
    operation = client.command(Command(SERVO), START)
    client.receive(ack(WINCH), START)
    client.receive(packet(common.CommandAck(command=SERVO), source=Address(2, 1)), START)
    assert not operation.done
    client.receive(ack(SERVO), START)  # old peers leave the targets 0
    assert operation.result().attempts == 1


def test_in_progress_stops_resending_and_lengthens_the_timer(client) -> None:
    operation = client.command(Command(WINCH), START)
    sent(client)
    client.receive(ack(WINCH, RESULT.IN_PROGRESS, progress=30), START)
    due = operation.next_timeout()
    assert due == START + PROGRESS_TIMEOUT
    client.handle_timeout(due - 1)
    assert not sent(client)
    client.handle_timeout(due)
    with pytest.raises(CommandTimeout, match="started, then no further answer"):
        operation.result()


@pytest.mark.parametrize(
    "result", [RESULT.COMMAND_INT_ONLY, RESULT.COMMAND_UNSUPPORTED_MAV_FRAME, RESULT.COMMAND_LONG_ONLY]
)
def test_the_other_form_is_tried_once(client, result) -> None:
    operation = client.command(Command(REPOSITION, param5=1.0), START)
    assert isinstance(sent(client)[0], common.CommandLong)
    client.receive(ack(REPOSITION, result), START)
    (again,) = sent(client)
    assert isinstance(again, common.CommandInt)
    assert again.x == 10_000_000
    client.receive(ack(REPOSITION, RESULT.COMMAND_LONG_ONLY), START)
    with pytest.raises(CommandDenied, match="COMMAND_LONG_ONLY"):
        operation.result()


def test_a_long_form_is_tried_after_an_int(client) -> None:
    client.command(Command(REPOSITION, param5=1.0, frame=6), START)
    assert isinstance(sent(client)[0], common.CommandInt)
    client.receive(ack(REPOSITION, RESULT.COMMAND_LONG_ONLY), START)
    (again,) = sent(client)
    assert isinstance(again, common.CommandLong)
    assert (again.param5, again.confirmation) == (1.0, 0)


def test_coordinates_of_command_int_cannot_be_nan() -> None:
    message = Command(REPOSITION, param5=nan, param6=nan, frame=6).to_int(VEHICLE)
    assert (message.x, message.y) == (0x7FFFFFFF, 0x7FFFFFFF)
    back = Command.read(message)
    assert isnan(back.param5)
    assert isnan(back.param6)


def test_a_rejection_of_a_repetition_may_come_from_our_own_first_one(client) -> None:
    operation = client.command(Command(WINCH), START)
    client.handle_timeout(operation.next_timeout())
    client.receive(ack(WINCH, RESULT.TEMPORARILY_REJECTED), START + 1)
    assert not operation.done
    client.receive(ack(WINCH), START + 5)
    assert operation.result().attempts == 2


def test_a_rejection_of_the_first_one_is_a_denial(client) -> None:
    operation = client.command(Command(WINCH), START)
    client.receive(ack(WINCH, RESULT.TEMPORARILY_REJECTED, result_param2=5), START)
    with pytest.raises(CommandDenied) as caught:
        operation.result()
    assert (caught.value.code, caught.value.detail) == (RESULT.TEMPORARILY_REJECTED, 5)


def test_two_commands_of_one_id_go_one_after_the_other(client) -> None:
    first, second = (client.command(Command(SERVO, param1=number), START) for number in (1, 2))
    assert [message.param1 for message in sent(client)] == [1]
    client.receive(ack(SERVO), START)
    assert first.done
    assert not second.done
    assert [message.param1 for message in sent(client)] == [2]


def test_cancelling_is_sent_to_the_vehicle(client) -> None:
    operation = client.command(Command(WINCH), START)
    sent(client)
    client.cancel(operation, START)
    assert [type(message) for message in sent(client)] == [common.CommandCancel]
    assert operation.done


def test_a_command_has_seven_parameters() -> None:
    assert Command.of(SERVO, [1, 2]).param2 == 2
    with pytest.raises(InvalidArgumentError, match="has 7"):
        Command.of(SERVO, range(8))


def test_a_result_without_a_name_is_a_denial(client) -> None:
    operation = client.command(Command(SERVO), START)
    client.receive(ack(SERVO, 77), START)
    with pytest.raises(CommandDenied, match="result 77"):
        operation.result()


def test_disarming_does_not_wait_for_an_arming(client) -> None:
    arming = client.command(Command(ARM, 1), START)
    client.receive(ack(ARM, RESULT.IN_PROGRESS), START)
    waiting = client.command(Command(ARM, 1, 21196), START)
    sent(client)
    disarming = client.command(Command(ARM, 0), START + 1)
    for operation in (arming, waiting):
        with pytest.raises(RemoteCancelled, match="superseded by COMPONENT_ARM_DISARM"):
            operation.result()
    cancel, request = sent(client)
    assert (cancel.command, request.command, request.param1) == (ARM, ARM, 0)
    client.receive(ack(ARM, RESULT.IN_PROGRESS), START + 1)  # both may be those of the arming
    client.receive(ack(ARM, RESULT.CANCELLED), START + 1)
    client.handle_timeout(disarming.next_timeout())
    (repetition,) = sent(client)
    assert (repetition.param1, repetition.confirmation) == (0, 1)
    client.receive(ack(ARM), START + 2)
    assert disarming.result().result == RESULT.ACCEPTED


def test_termination_ends_an_arming_and_other_commands_wait(client) -> None:
    arming = client.command(Command(ARM, 1), START)
    client.command(Command(ARM, 1), START)
    client.command(Command(SERVO), START)
    assert not arming.done
    client.command(Command(common.MavCmd.DO_FLIGHTTERMINATION, 0), START)
    assert not arming.done
    client.command(Command(common.MavCmd.DO_FLIGHTTERMINATION, 1), START)
    assert isinstance(arming.error, RemoteCancelled)


# The server


def answers(server, message, sequence=0, now=START, source=GROUND) -> list:
    server.receive(packet(message, source, sequence), now)
    return [message.result for message in sent(server)]


def test_a_duplicate_while_running_is_temporarily_rejected(server) -> None:
    assert answers(server, command_long(WINCH)) == [RESULT.IN_PROGRESS]
    assert answers(server, command_long(WINCH, param1=2), 1) == [RESULT.TEMPORARILY_REJECTED]
    assert answers(server, command_long(WINCH), 2) == [RESULT.TEMPORARILY_REJECTED]
    assert answers(server, command_long(WINCH), 3, source=Address(254, 1)) == [RESULT.TEMPORARILY_REJECTED]


def test_a_repeated_request_gets_the_progress(server) -> None:
    assert answers(server, command_long(WINCH)) == [RESULT.IN_PROGRESS]
    assert answers(server, command_long(WINCH, confirmation=1), 1) == [RESULT.IN_PROGRESS]
    assert len(server.running) == 1


def test_a_command_whose_answer_was_lost_is_not_carried_out_twice() -> None:
    server = CommandServer(VEHICLE)
    done = []
    server.support(SERVO, lambda request: done.append(request) or RESULT.ACCEPTED)
    assert answers(server, command_long(SERVO)) == [RESULT.ACCEPTED]
    assert answers(server, command_long(SERVO, confirmation=1), 1) == [RESULT.ACCEPTED]
    assert len(done) == 1
    assert answers(server, command_long(SERVO), 2) == [RESULT.ACCEPTED]  # requested again
    assert len(done) == 2


def test_a_packet_that_the_network_doubled_is_not_carried_out_twice() -> None:
    server = CommandServer(VEHICLE)
    done = []
    server.support(SERVO, lambda request: done.append(request) or RESULT.ACCEPTED)
    message = common.CommandInt(target_system=1, target_component=1, command=SERVO)
    for sequence in (4, 4, 5):
        assert answers(server, message, sequence) == [RESULT.ACCEPTED]
    assert len(done) == 2


def arming_server() -> tuple[CommandServer, list[float]]:
    """Return a server whose arming runs until the program ends it, and the list of what it began."""
    server, begun = CommandServer(VEHICLE), []

    def arm_or_disarm(request):
        begun.append(request.command.param1)
        return None if request.command.param1 else RESULT.ACCEPTED

    server.support(ARM, arm_or_disarm)
    return server, begun


def test_disarming_ends_a_running_arming_of_any_source() -> None:
    for number, source in enumerate((GROUND, Address(254, 1))):
        server, begun = arming_server()
        assert answers(server, command_long(ARM, param1=1)) == [RESULT.IN_PROGRESS]
        (request,) = server.running
        disarming = answers(server, command_long(ARM, param1=0), 1 + number, source=source)
        assert disarming == [RESULT.CANCELLED, RESULT.ACCEPTED]
        assert begun == [1, 0]
        assert not server.running
        assert CommandCancelRequested(request) in server.events()
        server.complete(request, RESULT.ACCEPTED)  # too late
        assert sent(server) == []


def test_a_late_copy_or_repetition_of_the_arming_does_not_arm_after_the_disarming() -> None:
    server, begun = arming_server()
    answers(server, command_long(ARM, param1=1), 7)
    answers(server, command_long(ARM, param1=0), 8)
    assert answers(server, command_long(ARM, param1=1), 7, START + 0.3) == [RESULT.CANCELLED]
    assert answers(server, command_long(ARM, confirmation=1, param1=1), 9, START + 3) == [RESULT.CANCELLED]
    assert begun == [1, 0]
    assert answers(server, command_long(ARM, param1=1), 10, START + 4) == [RESULT.IN_PROGRESS]


def test_a_late_copy_of_an_answered_command_is_not_carried_out_after_another() -> None:
    server = CommandServer(VEHICLE)
    done = []
    server.support(ARM, lambda request: done.append(request.command.param1) or RESULT.ACCEPTED)
    for sequence, param1 in ((1, 1), (2, 0), (1, 1)):
        assert answers(server, command_long(ARM, param1=param1), sequence) == [RESULT.ACCEPTED]
    assert done == [1, 0]
    # Its first packet was lost: a new request, although its confirmation is not 0.
    answers(server, command_long(ARM, confirmation=1, param1=1), 4, START + 10)
    assert done == [1, 0, 1]


def test_flight_termination_ends_an_arming_and_arming_twice_does_not() -> None:
    server, _ = arming_server()
    server.support(common.MavCmd.DO_FLIGHTTERMINATION, lambda _: RESULT.ACCEPTED)
    answers(server, command_long(ARM, param1=1))
    assert answers(server, command_long(ARM, param1=1), 1) == [RESULT.TEMPORARILY_REJECTED]
    terminating = answers(server, command_long(common.MavCmd.DO_FLIGHTTERMINATION, param1=1), 2)
    assert terminating == [RESULT.CANCELLED, RESULT.ACCEPTED]


def test_only_the_addressed_component_answers_unsupported(server) -> None:
    takeoff = common.MavCmd.NAV_TAKEOFF
    assert answers(server, command_long(takeoff)) == [RESULT.UNSUPPORTED]
    assert answers(server, command_long(takeoff, target=Address(1, 0)), 1) == [RESULT.UNSUPPORTED]
    camera = CommandServer(Address(1, 100))
    assert answers(camera, command_long(takeoff, target=Address(1, 0))) == []
    assert answers(camera, command_long(takeoff, target=Address(1, 100)), 1) == [RESULT.UNSUPPORTED]
    assert answers(camera, command_long(takeoff, target=Address(0, 0)), 2) == []


def test_a_cancel_reaches_the_program_and_its_end_the_sender(server) -> None:
    answers(server, command_long(WINCH))
    cancel = common.CommandCancel(target_system=1, target_component=1, command=WINCH)
    server.receive(packet(cancel, Address(254, 1)), START)  # not the sender
    assert not [event for event in server.events() if isinstance(event, CommandCancelRequested)]
    server.receive(packet(cancel, GROUND), START)
    (event,) = server.events()
    server.complete(event.request, RESULT.CANCELLED)
    assert [message.result for message in sent(server)] == [RESULT.CANCELLED]
    server.receive(packet(cancel, GROUND), START)  # idle: ignored
    assert server.events() == []


def test_progress_is_repeated_and_ends_with_one_answer(server) -> None:
    answers(server, command_long(WINCH))
    (request,) = server.running
    server.progress(request, 40, START)
    server.handle_timeout(START + 2)
    assert [message.progress for message in sent(server)] == [40, 40]
    server.complete(request, RESULT.ACCEPTED, 3)
    server.complete(request, RESULT.FAILED)
    (message,) = sent(server)
    assert (message.result, message.result_param2, message.target_system) == (RESULT.ACCEPTED, 3, 255)


def test_memory_of_answers_is_bounded(server) -> None:
    for number in range(2000):
        answers(server, command_long(SERVO), source=Address(1 + number % 250, 1 + number // 250))
    assert len(server._answered) <= 256
