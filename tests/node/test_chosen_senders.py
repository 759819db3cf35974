"""Several vehicles with one system id: acting is refused until one is chosen, then only that one counts."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, SystemIdConflictError
from mavstack.node.engine import Engine
from mavstack.services import Address
from mavstack.services.acting import acts
from mavstack.services.command import Command, CommandClient
from mavstack.services.heartbeat import Discovery
from mavstack.services.version import AutopilotVersion
from mavstack.wire import encode
from tests.services.network import GROUND, START, VEHICLE

COPTER = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
ARM = common.CommandLong(target_system=1, target_component=1, command=common.MavCmd.COMPONENT_ARM_DISARM)
READ = common.ParamRequestRead(target_system=1, target_component=1, param_id="A", param_index=-1)
SET = common.ParamSet(target_system=1, target_component=1, param_id="A")


class Station:
    """An engine with two channels, on which two boards use one address."""

    def __init__(self) -> None:
        self.engine = engine = Engine(GROUND)
        self.discovery = engine.add(
            Discovery(GROUND, channel_name=engine.arrival_channel, is_excluded=engine.arrived_excluded)
        )
        engine.senders.systems = self.discovery.conflicts
        engine.senders.conflict_of = self.discovery.vehicle_conflict
        self.now = START
        engine.on_channel_closed = lambda name: self.discovery.forget_channel(name, self.now)
        self.one, self.other = (engine.open_channel(f"udpin 10.0.0.{host}:14550") for host in (1, 2))

    def receive(self, channel, *messages):
        received = []
        for message in messages:
            self.now += 0.01
            received += self.engine.receive(channel, encode(message, system=1, component=1), self.now)
        return received

    def conflict(self):
        for _ in range(2):
            for uid, channel in enumerate((self.one, self.other), start=1):
                self.receive(channel, COPTER, AutopilotVersion(uid=uid).to_message())
        return self

    def sent(self):
        return [(channel.name, data) for channel, data in self.engine.data_to_send(self.now)]


def arm(station):
    client = station.engine.add(CommandClient(GROUND, VEHICLE))
    operation = client.command(Command(common.MavCmd.COMPONENT_ARM_DISARM, 1), station.now)
    station.engine.touch(client)
    return operation


def test_what_acts_is_refused_and_names_both_senders():
    station = Station().conflict()
    operation = arm(station)
    assert not station.sent()
    with pytest.raises(SystemIdConflictError) as caught:
        operation.result()
    text = str(caught.value)
    assert text.startswith("COMPONENT_ARM_DISARM on 1/1 failed: 2 vehicles use system id 1: ")
    assert "10.0.0.1:14550" in text
    assert "10.0.0.2:14550" in text
    assert "unique id" in text
    for message in (ARM, SET):
        with pytest.raises(SystemIdConflictError):
            station.engine.send(message, station.now)


def test_reading_continues():
    station = Station().conflict()
    station.engine.send(READ, station.now)
    assert len(station.sent()) == 1


@pytest.mark.parametrize("text", ["10.0.0.2:14550", "udpin 10.0.0.2:14550"])
def test_after_the_choice_only_the_chosen_one_counts(text):
    station = Station().conflict()
    station.engine.senders.choose(1, text)
    operation = arm(station)
    assert [name for name, _ in station.sent()] == [station.other.name]
    assert not operation.done
    assert station.receive(station.other, COPTER)
    armed = common.Heartbeat(type=COPTER.type, autopilot=COPTER.autopilot, base_mode=128)
    assert not station.receive(station.one, armed)
    assert not station.discovery.components[VEHICLE].armed
    assert station.discovery.has_conflict(VEHICLE)
    station.engine.senders.choose(1, None)
    with pytest.raises(SystemIdConflictError):
        station.engine.send(ARM, station.now)


def test_a_choice_ends_with_its_channel_and_the_conflict_with_the_second_sender():
    station = Station().conflict()
    station.engine.senders.choose(1, "10.0.0.2:14550")
    station.engine.close_channel(station.other)
    assert station.engine.senders.chosen(1) is None
    assert not station.discovery.has_conflict(VEHICLE)
    station.engine.send(ARM, station.now)
    assert [name for name, _ in station.sent()] == [station.one.name]


def test_senders_on_one_channel_cannot_be_chosen():
    station = Station()
    for uid in (1, 2, 1, 2):
        station.receive(station.one, COPTER, AutopilotVersion(uid=uid).to_message())
    assert station.discovery.has_conflict(VEHICLE)
    with pytest.raises(InvalidArgumentError, match="connect to one of them directly"):
        station.engine.senders.choose(1, "10.0.0.1:14550")
    with pytest.raises(InvalidArgumentError, match="no open channel is named 'x'"):
        station.engine.senders.choose(1, "x")


def test_a_transfer_that_is_under_way_ends():
    station = Station()
    station.receive(station.one, COPTER)
    operation = arm(station)
    assert station.sent()
    station.conflict()
    station.now += 5
    station.engine.handle_timeout(station.now)
    assert not station.sent()
    with pytest.raises(SystemIdConflictError):
        operation.result()


def test_other_vehicles_are_not_concerned():
    station = Station().conflict()
    station.engine.send(ARM.replace(target_system=2), station.now, Address(2, 1))
    assert station.sent()


def test_a_gimbal_with_the_autopilots_address_is_no_second_vehicle():
    station = Station()
    gimbal = common.Heartbeat(type=common.MavType.GIMBAL, autopilot=common.MavAutopilot.INVALID)
    for _ in range(5):
        station.receive(station.one, COPTER)
        station.receive(station.other, gimbal)
    assert station.discovery.has_conflict(VEHICLE)
    station.engine.send(ARM, station.now)
    assert station.sent()


def test_a_limit_to_one_channel():
    station = Station()
    station.engine.senders.limit_to("10.0.0.2:14550")
    assert not station.receive(station.one, COPTER)
    assert station.receive(station.other, COPTER)
    station.engine.send(ARM, station.now)
    assert [name for name, _ in station.sent()] == [station.other.name]


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (ARM, True),
        (SET, True),
        (READ, False),
        (ARM.replace(command=common.MavCmd.REQUEST_MESSAGE), False),
        (common.FileTransferProtocol(payload=bytes([0, 0, 0, 5])), False),
        (common.FileTransferProtocol(payload=bytes([0, 0, 0, 7])), True),
        (common.ManualControl(), True),
        (common.MissionRequestList(), False),
        (COPTER, False),
    ],
)
def test_messages_that_act(message, expected):
    assert acts(message) is expected
