"""The engine: delivery, routing, duplicates, timers and pacing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import EncodeError
from mavstack.node.duplicates import MAX_PACKETS, Duplicates
from mavstack.node.engine import Engine
from mavstack.security import SigningKey
from mavstack.services import Address, Client, Event, Outgoing, Priority, Service, message_ids
from mavstack.services.command import Command, CommandClient
from mavstack.wire import Packet, Parser, encode
from tests.services.network import GROUND, START, VEHICLE, HalfDuplexRadio, Network

if TYPE_CHECKING:
    from collections.abc import Iterator


class Recorder(Service):
    """A service that records its packets."""

    handles = message_ids(common.ParamValue, common.ParamSet)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self.received: list[Packet] = []
        self.ticks: list[float] = []
        self.due: float | None = None

    def receive(self, packet: Packet, now: float) -> None:
        self.received.append(packet)
        self.emit(Event())

    def next_timeout(self) -> float | None:
        return self.due

    def handle_timeout(self, now: float) -> None:
        self.ticks.append(now)
        self.due = None


class BulkSender(Service):
    """A service that sends bulk messages while the channel has room."""

    def __init__(self, local: Address, target: Address, total: int) -> None:
        super().__init__(local)
        self.target, self.left = target, total

    def bulk_messages(self, now, has_room) -> Iterator[Outgoing]:
        while self.left and has_room(self.target):
            self.left -= 1
            yield Outgoing(common.ParamValue(param_index=self.left), self.target, Priority.BULK)


def engine_with(*channels: str) -> tuple[Engine, list]:
    engine = Engine(GROUND)
    return engine, [engine.open_channel(name) for name in channels]


def bytes_of(message, source: Address = VEHICLE, sequence: int = 0) -> bytes:
    return encode(message, system=source.system, component=source.component, sequence=sequence)


def test_a_service_gets_packets_by_message_id_and_target() -> None:
    engine, (wire,) = engine_with("wire")
    recorder = engine.add(Recorder(GROUND))
    for message in (
        common.ParamValue(),
        common.Attitude(),
        common.ParamSet(target_system=255, target_component=190),
        common.ParamSet(target_system=255, target_component=0),
        common.ParamSet(target_system=0, target_component=0),
        common.ParamSet(target_system=255, target_component=191),
        common.ParamSet(target_system=1, target_component=1),
    ):
        engine.receive(wire, bytes_of(message), START)
    assert len(recorder.received) == 4
    engine.receive(wire, bytes_of(common.ParamValue(), source=GROUND), START)  # an own packet, echoed
    assert len(recorder.received) == 4
    engine.remove(recorder)
    engine.receive(wire, bytes_of(common.ParamValue()), START)
    assert len(recorder.received) == 4


def test_a_service_may_have_another_address() -> None:
    engine, (wire,) = engine_with("wire")
    gimbal = engine.add(Recorder(Address(255, 154)))
    message = common.ParamSet(target_system=255, target_component=154)
    engine.receive(wire, bytes_of(message), START)
    assert len(gimbal.received) == 1
    gimbal.send(common.ParamValue())
    engine.touch(gimbal)
    ((_, data),) = engine.data_to_send(START)
    assert Packet(data, common).component == 154


def test_sequences_count_per_channel_and_component() -> None:
    engine, _ = engine_with("a", "b")
    for _ in range(3):
        engine.send(common.Heartbeat(), START)
    engine.send(common.Heartbeat(), START, source=Address(255, 100))
    numbers: dict = {}
    for channel, data in engine.data_to_send(START):
        packet = Packet(data, common)
        numbers.setdefault((channel.name, packet.component), []).append(packet.sequence)
    assert numbers == {(name, 190): [0, 1, 2] for name in "ab"} | {(name, 100): [0] for name in "ab"}


def test_a_client_gets_packets_of_its_target_and_those_of_its_operations() -> None:
    engine, (wire,) = engine_with("wire")
    received = []

    class ObservingClient(Client):
        handles = message_ids(common.ParamValue)

        def observe(self, packet: Packet, now: float) -> None:
            received.append((packet.system, packet.message_id))

    client = engine.add(ObservingClient(GROUND, VEHICLE))
    engine.receive(wire, bytes_of(common.ParamValue()), START)
    engine.receive(wire, bytes_of(common.ParamValue(), source=Address(2, 1)), START)
    engine.receive(wire, bytes_of(common.Attitude()), START)
    assert received == [(1, 22)]
    client.handles = message_ids(common.Attitude)
    engine.touch(client)
    engine.data_to_send(START)
    engine.receive(wire, bytes_of(common.Attitude()), START)
    engine.receive(wire, bytes_of(common.ParamValue()), START)
    assert received == [(1, 22), (1, 30)]


def test_duplicates_over_a_second_channel_are_dropped() -> None:
    engine, (one, two) = engine_with("one", "two")
    recorder = engine.add(Recorder(GROUND))
    for sequence in range(5):
        data = bytes_of(common.ParamValue(param_index=sequence), sequence=sequence)
        engine.receive(one, data, START)
        engine.receive(two, data, START)
    # The first packet shows that there are two channels; each later one is delivered once.
    assert [packet.sequence for packet in recorder.received] == [0, 0, 1, 2, 3, 4]
    assert engine.duplicates.dropped == 4


def test_equal_bytes_on_one_channel_are_no_duplicate() -> None:
    duplicates: Duplicates[str] = Duplicates()
    packet = Packet(bytes_of(common.Heartbeat()), common)
    assert not duplicates.is_copy(packet, "a", 0.0)
    assert not duplicates.is_copy(packet, "a", 0.1)
    assert duplicates.is_copy(packet, "b", 0.2)
    assert not duplicates.is_copy(packet, "b", 5.0)
    for number in range(5000):
        duplicates.is_copy(Packet(bytes_of(common.Attitude(time_boot_ms=number)), common), "a", 5.0)
    assert len(duplicates._seen) <= MAX_PACKETS


def test_timers_fire_once_when_due_and_follow_changes() -> None:
    engine, _ = engine_with("wire")
    recorder = engine.add(Recorder(GROUND))
    recorder.due = START + 5
    engine.data_to_send(START)
    assert engine.next_timeout() == START + 5
    recorder.due = START + 2
    engine.touch(recorder)
    engine.data_to_send(START)
    assert engine.next_timeout() == START + 2
    engine.handle_timeout(START + 3)
    engine.data_to_send(START + 3)
    engine.handle_timeout(START + 9)
    assert recorder.ticks == [START + 3]
    assert engine.next_timeout() is None


def test_bulk_messages_wait_for_room() -> None:
    network = Network()
    radio = HalfDuplexRadio()
    ground = network.node(GROUND)
    vehicle = network.node(VEHICLE)
    network.connect(ground, vehicle, radio=radio, bandwidth=5760.0)
    recorder = ground.engine.add(Recorder(GROUND))
    vehicle.engine.add(BulkSender(VEHICLE, GROUND, total=1000))
    begin = network.now
    assert network.run(lambda: len(recorder.received) == 1000, timeout=60)
    assert radio.overflowed == 0
    min_duration = radio.carried / 5760
    assert min_duration <= network.now - begin <= min_duration * 1.1


def test_bulk_messages_wait_for_a_channel() -> None:
    engine = Engine(GROUND)
    sender = engine.add(BulkSender(GROUND, VEHICLE, total=3))
    assert engine.data_to_send(START) == []
    assert sender.left == 3
    engine.open_channel("late")
    assert len(engine.data_to_send(START)) == 3


def test_radio_status_paces_its_channel() -> None:
    engine, (radio, wire) = engine_with("radio", "wire")
    engine.receive(radio, bytes_of(common.RadioStatus(txbuf=40), source=Address(51, 68)), START)
    assert radio.pacer.learned
    assert wire.pacer.bandwidth is None


def test_nothing_is_written_to_a_closed_channel() -> None:
    engine, (one, _) = engine_with("one", "two")
    engine.send(common.Heartbeat(), START)
    engine.close_channel(one)
    assert [channel.name for channel, _ in engine.data_to_send(START)] == ["two"]


def test_signing_can_start_on_an_open_channel() -> None:
    engine, (wire,) = engine_with("wire")
    engine.send(common.Heartbeat(), START)
    key = SigningKey.generate()
    wire.signing = key.signing()
    engine.send(common.Heartbeat(), START)
    packets = [Packet(data, common) for _, data in engine.data_to_send(START)]
    assert [(packet.signed, packet.sequence) for packet in packets] == [(False, 0), (True, 1)]
    checker = Parser(common, signing=key.signing())
    assert len(checker.feed(packets[1].raw, START)) == 1
    assert engine.receive(wire, bytes_of(common.ParamValue()), START) == []  # unsigned: refused now


def test_messages_that_version_1_cannot_carry() -> None:
    engine = Engine(GROUND)
    old = engine.open_channel("old", version=1)
    recorder = engine.add(Recorder(GROUND))
    recorder.send(common.ProtocolVersion())
    engine.touch(recorder)
    assert engine.data_to_send(START) == []
    assert old.unsendable == 1
    with pytest.raises(EncodeError):
        engine.send(common.ProtocolVersion(), START)


def test_a_slow_channel_drops_only_its_own_stream_messages() -> None:
    class Telemetry(Service):
        def __init__(self) -> None:
            super().__init__(GROUND)
            self.due = 50

        def bulk_messages(self, now, has_room) -> Iterator[Outgoing]:
            while self.due and has_room(Address(0, 0), Priority.STREAM):
                self.due -= 1
                yield Outgoing(common.Attitude(), Address(0, 0), Priority.STREAM)

    engine = Engine(GROUND)
    slow, fast = engine.open_channel("slow", bandwidth=1000), engine.open_channel("fast")
    engine.add(Telemetry())
    sent = [channel.name for channel, _ in engine.data_to_send(START)]
    assert sent.count("fast") == 50
    assert sent.count("slow") + slow.thinned == 50
    assert 0 < slow.thinned < 50
    assert fast.thinned == 0


def test_answers_to_another_ground_station_are_ignored() -> None:
    engine, (wire,) = engine_with("wire")
    client = engine.add(CommandClient(GROUND, VEHICLE))
    operation = client.command(Command(common.MavCmd.DO_SET_SERVO), START)
    for system, component in ((254, 190), (255, 191)):
        ack = common.CommandAck(
            command=common.MavCmd.DO_SET_SERVO, target_system=system, target_component=component
        )
        engine.receive(wire, bytes_of(ack), START)
        assert not operation.done
    mine = common.CommandAck(command=common.MavCmd.DO_SET_SERVO, target_system=255, target_component=190)
    engine.receive(wire, bytes_of(mine), START)
    assert operation.done
