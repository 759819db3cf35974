from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import BROADCAST, Priority
from mavstack.services.command import Command, CommandOperation, CommandServer
from mavstack.services.message_request import MessageServer, RequestMessage
from tests.services.message_request.harness import RequestHarness
from tests.services.network import GROUND, START, VEHICLE, HalfDuplexRadio
from tests.services.single_service import feed_random_messages, packet_of, sent_by


def stream_request(group: int, rate: int = 10, on: int = 1) -> common.RequestDataStream:
    return common.RequestDataStream(
        target_system=1, target_component=1, req_stream_id=group, req_message_rate=rate, start_stop=on
    )


def test_a_default_rate_is_kept() -> None:
    harness = RequestHarness()
    harness.run_for(10.1)
    assert len(harness.received(common.Attitude)) == 41
    assert harness.received(common.HomePosition) == []


def test_a_rate_that_was_requested_is_kept() -> None:
    harness = RequestHarness()
    harness.run(CommandOperation(Command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, 20_000)))
    before = len(harness.received(common.Attitude))
    harness.run_for(10)
    assert len(harness.received(common.Attitude)) - before == pytest.approx(500, abs=2)


@pytest.mark.parametrize("wanted", [-2.0, float("nan"), float("inf")])
def test_an_interval_that_is_none_is_denied(wanted: float) -> None:
    harness = RequestHarness()
    operation = harness.run(CommandOperation(Command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, wanted)))
    assert operation.error.code == common.MavResult.DENIED
    assert harness.messages.interval_of(30) == 250_000


def test_no_rate_floods() -> None:
    harness = RequestHarness()
    harness.run(CommandOperation(Command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, 1.0)))
    assert harness.messages.interval_of(common.Attitude) == 1_000


def test_a_producer_without_a_message() -> None:
    harness = RequestHarness()
    operation = harness.run(RequestMessage(common.VfrHud))
    assert operation.error.code == common.MavResult.FAILED


def test_instances_by_request_and_by_the_older_command() -> None:
    harness = RequestHarness()

    def storage(number: float, now: float) -> common.StorageInformation | None:
        return common.StorageInformation(storage_id=int(number)) if number in (1, 2) else None

    harness.messages.provide_instances(common.StorageInformation, storage)
    assert harness.run(RequestMessage(common.StorageInformation, (2,))).result().storage_id == 2
    harness.run(CommandOperation(Command(common.MavCmd.REQUEST_STORAGE_INFORMATION, 1, 1)))
    assert harness.received(common.StorageInformation)[-1].storage_id == 1
    assert harness.run(RequestMessage(common.StorageInformation, (9,))).error is not None
    assert harness.messages.interval_of(common.StorageInformation) == -1


def test_data_streams_of_the_older_way() -> None:
    harness = RequestHarness()
    client, server = harness.ground.engine, harness.messages
    client.send(stream_request(common.MavDataStream.EXTRA1), harness.network.now)
    harness.run_for(1)
    assert server.interval_of(common.Attitude) == 100_000
    assert harness.received(common.DataStream) == [common.DataStream(stream_id=10, message_rate=10, on_off=1)]
    client.send(stream_request(common.MavDataStream.EXTRA1, on=0), harness.network.now)
    harness.run_for(1)
    assert server.interval_of(common.Attitude) == -1
    client.send(stream_request(common.MavDataStream.ALL, 2), harness.network.now)
    harness.run_for(1)
    assert server.interval_of(common.Attitude) == 500_000
    assert server.interval_of(common.HomePosition) == -1, "what is sent only on request stays so"


def test_stream_groups_come_from_the_component() -> None:
    harness = RequestHarness()
    client, server = harness.ground.engine, harness.messages
    attitude, home = (kind.__mavlink_row__[0] for kind in (common.Attitude, common.HomePosition))
    server.data_streams = {common.MavDataStream.ALL: frozenset({attitude, home}), 10: frozenset({home})}
    client.send(stream_request(common.MavDataStream.EXTRA1), harness.network.now)
    harness.run_for(1)
    assert server.interval_of(common.HomePosition) == 100_000
    assert server.interval_of(common.Attitude) == 250_000, "it is in another group here"
    client.send(stream_request(common.MavDataStream.ALL, 2), harness.network.now)
    harness.run_for(1)
    assert server.interval_of(common.HomePosition) == server.interval_of(common.Attitude) == 500_000
    server.data_streams = {}
    received = len(harness.received(common.DataStream))
    client.send(stream_request(common.MavDataStream.ALL, 1), harness.network.now)
    harness.run_for(1)
    assert server.interval_of(common.Attitude) == 500_000, "no such request is known"
    assert len(harness.received(common.DataStream)) == received


def test_the_program_may_change_its_default_rates() -> None:
    harness = RequestHarness()
    harness.run_for(1)
    before = len(harness.received(common.Attitude))
    harness.messages.set_interval(common.Attitude, 0.05, harness.network.now)
    harness.vehicle.engine.touch(harness.messages)
    harness.run_for(5)
    assert len(harness.received(common.Attitude)) - before == pytest.approx(100, abs=2)
    harness.run(CommandOperation(Command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, 1_000_000)))
    harness.run(CommandOperation(Command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, 0)))
    assert harness.messages.interval_of(common.Attitude) == 50_000
    harness.messages.set_interval(common.Attitude, 0, harness.network.now)
    harness.vehicle.engine.touch(harness.messages)
    before = len(harness.received(common.Attitude))
    harness.run_for(5)
    assert len(harness.received(common.Attitude)) - before <= 1


def test_a_full_link_thins_telemetry_instead_of_queueing_it() -> None:
    radio = HalfDuplexRadio()
    harness = RequestHarness(radio=radio, bandwidth=5760.0)
    now = harness.network.now
    for kind in (common.GlobalPositionInt, common.RawImu, common.SysStatus):
        harness.messages.provide(kind, lambda _, kind=kind: kind(), interval=0.01, now=now)
    harness.messages.provide(
        common.SystemTime,
        lambda now: common.SystemTime(time_unix_usec=round(now * 1e6)),
        interval=0.01,
        now=now,
    )
    harness.vehicle.engine.touch(harness.messages)
    worst = 0.0
    for _ in range(400):
        harness.run_for(0.05)
        worst = max(worst, radio.waiting(1, harness.network.now))
    assert radio.overflowed == 0
    assert worst < 5760 * 0.25
    counts = [
        len(harness.received(kind)) for kind in (common.GlobalPositionInt, common.RawImu, common.SysStatus)
    ]
    assert min(counts) > 0.8 * max(counts), "all kinds are thinned alike"
    ages = [p.timestamp for p in harness.ground.received if isinstance(p.message, common.SystemTime)]
    assert len(ages) > 100


def test_overdue_messages_go_first() -> None:
    server = MessageServer(VEHICLE, CommandServer(VEHICLE))
    kinds = (common.Attitude, common.RawImu, common.SysStatus)
    for kind in kinds:
        server.provide(kind, lambda _, kind=kind: kind(), interval=0.01, now=START)
    sent = []
    for turn in range(30):
        room = iter([True, False])
        sent += server.messages_to_send(START + turn, lambda *_, room=room: next(room))
    assert [sum(isinstance(outgoing.message, kind) for outgoing in sent) for kind in kinds] == [10, 10, 10]


def test_what_is_late_is_made_fresh_and_not_made_up_for() -> None:
    server = MessageServer(VEHICLE, CommandServer(VEHICLE))
    server.provide(
        common.SystemTime,
        lambda now: common.SystemTime(time_boot_ms=round(now - START)),
        interval=1,
        now=START,
    )

    def full(target, priority=Priority.BULK) -> bool:
        assert (target, priority) == (BROADCAST, Priority.STREAM)
        return False

    assert list(server.messages_to_send(START, full)) == []
    assert server.next_timeout() > START, "a stream without room may not spin"
    messages = sent_by(server, START + 10)
    assert [message.time_boot_ms for message in messages] == [10]
    assert server.next_timeout() == START + 11


@pytest.mark.parametrize("seed", range(20))
def test_garbage_never_raises(seed: int) -> None:
    commands = CommandServer(VEHICLE)
    server = MessageServer(VEHICLE, commands)
    server.provide(common.Attitude, lambda _: common.Attitude(), interval=1, now=START)
    feed_random_messages(server, [common.RequestDataStream, common.CommandLong, common.CommandInt], seed)
    for command in (511, 512, 510):
        for value in (-1.0, 0.0, 30.0, 1e30, float("nan"), float("inf"), 30.5):
            for other in (-1.0, float("nan"), float("-inf"), 1e30, 0.4):
                message = common.CommandLong(command=command, param1=value, param2=other, confirmation=0)
                commands.receive(packet_of(message, GROUND), START + value if value < 99 else START)
                sent_by(commands)
                sent_by(server, START + 1)


def test_a_producer_may_make_several_messages() -> None:
    harness = RequestHarness()
    both = [common.GimbalManagerStatus(gimbal_device_id=1), common.GimbalManagerStatus(gimbal_device_id=2)]
    harness.messages.provide(common.GimbalManagerStatus, lambda now: both, interval=1.0, now=START)
    harness.run_for(3.1)
    assert [each.gimbal_device_id for each in harness.received(common.GimbalManagerStatus)] == [1, 2] * 4


class TriggeredHarness(RequestHarness):
    """A vehicle whose ATTITUDE is sent when a value arrives."""

    def provide(self) -> None:
        self.made = 0
        self.messages.provide(common.Attitude, self.make, interval=0.1, triggered=True)

    def make(self, now: float) -> common.Attitude:
        self.made += 1
        return common.Attitude(roll=self.made)

    def feed(self, interval: float, count: int) -> int:
        """Trigger the message at an interval; return how many were received."""
        before = len(self.received(common.Attitude))
        for _ in range(count):
            self.messages.trigger(common.Attitude, self.network.now)
            self.vehicle.engine.touch(self.messages)
            self.run_for(interval)
        self.run_for(1.0)
        return len(self.received(common.Attitude)) - before


def test_a_triggered_message_is_sent_with_its_values() -> None:
    harness = TriggeredHarness()
    harness.run_for(5)
    assert harness.received(common.Attitude) == []
    assert harness.feed(0.1, 50) == 50


@pytest.mark.parametrize(("interval", "count"), [(0.05, 100), (0.01, 500), (0.07, 71)])
def test_a_triggered_message_is_not_sent_more_often_than_at_its_interval(interval: float, count: int) -> None:
    assert TriggeredHarness().feed(interval, count) == pytest.approx(50, abs=2)


def test_the_rate_of_a_triggered_message_can_be_requested() -> None:
    harness = TriggeredHarness()
    harness.run(CommandOperation(Command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, 1_000_000)))
    assert harness.messages.interval_of(common.Attitude) == 1_000_000
    assert harness.feed(0.1, 50) == pytest.approx(5, abs=1)
    harness.run(CommandOperation(Command(common.MavCmd.SET_MESSAGE_INTERVAL, 30, -1)))
    assert harness.feed(0.1, 10) == 0
    assert harness.run(RequestMessage(common.Attitude)).result().roll == harness.made
