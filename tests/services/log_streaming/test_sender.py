"""The sender: definitions until they are acknowledged, then records; over any network the log is valid."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services.command import CommandClient, CommandServer
from mavstack.services.command.command import Command
from mavstack.services.log_streaming import (
    LogStreamData,
    LogStreamReceiver,
    LogStreamSender,
    LogStreamStarted,
    LogStreamStopped,
)
from mavstack.services.log_streaming.sender import ACK_TIMEOUT, MAX_TRIES, MAX_WAITING
from tests.services.log_streaming.test_assembler import HEADER, message, messages_in
from tests.services.network import GROUND, START, VEHICLE, Network, random_impairment
from tests.services.single_service import deliver, feed_random_messages, run_timers, sent_by

START_COMMAND, STOP_COMMAND = common.MavCmd.LOGGING_START, common.MavCmd.LOGGING_STOP
DEFINITIONS = HEADER + b"".join(message(bytes([number]) * 90) for number in range(30))
RECORDS = [message(bytes([number % 256]) * 60) for number in range(200)]


def ordered(sender, command, *params, source=GROUND):
    """Let the client send a command; return the answer."""
    commands = CommandServer(VEHICLE)
    sender.answer_commands(commands, lambda service: None)
    deliver(commands, Command.of(command, params).to_long(VEHICLE), source, START)
    (ack,) = sent_by(commands)
    return ack.result


def started() -> LogStreamSender:
    sender = LogStreamSender(VEHICLE)
    assert ordered(sender, START_COMMAND) == common.MavResult.ACCEPTED
    assert sender.events() == [LogStreamStarted(GROUND)]
    return sender


def test_one_client_receives_the_log():
    sender = started()
    other = GROUND._replace(system=254)
    assert ordered(sender, START_COMMAND, source=other) == common.MavResult.TEMPORARILY_REJECTED
    assert ordered(sender, STOP_COMMAND, source=other) == common.MavResult.DENIED
    assert ordered(sender, STOP_COMMAND) == common.MavResult.ACCEPTED
    assert sender.events() == [LogStreamStopped("")]
    assert ordered(sender, STOP_COMMAND) == common.MavResult.ACCEPTED
    assert ordered(sender, START_COMMAND, 1) == common.MavResult.UNSUPPORTED
    assert sender.client is None


def test_without_acknowledgements_the_stream_ends():
    sender = started()
    sender.write(DEFINITIONS, START, acknowledged=True)
    sent = run_timers(sender, START + 60)
    assert len(sent) == MAX_TRIES
    assert {message.sequence for _, message in sent} == {0}
    assert round(sent[1][0] - sent[0][0], 6) == ACK_TIMEOUT
    assert [type(event) for event in sender.events()] == [LogStreamStopped]
    assert sender.client is None


def test_without_room_the_oldest_blocks_are_dropped():
    sender = started()
    for _ in range(10):
        for record in RECORDS:
            sender.write(record, START)
    assert sent_by(sender, has_room=lambda *_: False) == []
    sent = sent_by(sender)
    assert len(sent) == MAX_WAITING
    assert sent[0].sequence == sender.dropped > 0


def test_random_messages():
    feed_random_messages(started(), [common.LoggingAck], seed=2)


def test_a_log_over_any_network(seeds):
    """The definitions are complete, the records a part of those sent, and each message is whole."""

    def scenario(seed: int) -> None:
        network = Network(seed)
        sender, receiver = LogStreamSender(VEHICLE), LogStreamReceiver(GROUND, VEHICLE)
        commands, client = CommandServer(VEHICLE), CommandClient(GROUND, VEHICLE)

        def vehicle_services(engine) -> None:
            engine.add(sender)
            sender.answer_commands(commands, engine.touch)
            engine.add(commands)

        vehicle = network.node(VEHICLE, vehicle_services)
        ground = network.node(GROUND, lambda engine: (engine.add(receiver), engine.add(client)))
        network.connect(vehicle, ground, random_impairment(network.random, worst_loss=0.2))
        operation = client.command(Command.of(START_COMMAND, ()), network.now)
        ground.engine.touch(client)
        network.run(lambda: bool(vehicle.events_of(LogStreamStarted)) or operation.done, timeout=60)
        sender.write(DEFINITIONS, network.now, acknowledged=True)
        vehicle.engine.touch(sender)
        for number, record in enumerate(RECORDS):
            network.at(
                1 + number / 100,
                lambda record=record: (sender.write(record, network.now), vehicle.engine.touch(sender)),
            )
        network.run(timeout=120)
        log = b"".join(event.data for event in ground.events_of(LogStreamData))
        if vehicle.events_of(LogStreamStopped) or not operation.done or operation.error:
            return
        assert log.startswith(DEFINITIONS)
        sent = iter(RECORDS)
        found = messages_in(HEADER + log[len(DEFINITIONS) :])
        assert all(each in sent for each in found if each[2:3] != b"O")
        assert found, "a queue that overflows drops the end, but never all"

    seeds.check(scenario)
