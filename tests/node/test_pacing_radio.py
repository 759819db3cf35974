"""A 57,600-baud half-duplex radio to ten vehicles: transfers leave room for heartbeats and commands."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.command import Command, CommandClient, CommandServer
from mavstack.services.heartbeat import ComponentLost, Discovery, HeartbeatSender
from mavstack.services.message_request import MessageServer
from mavstack.services.mission import MissionClient, MissionItem, MissionServer, Plan
from mavstack.services.parameters import ParameterClient, ParameterServer
from tests.services.network import GROUND, Network, Node
from tests.services.radio import SharedMedium, call_every, radio_network

if TYPE_CHECKING:
    from mavstack.node.engine import Engine

VEHICLES = [Address(number, 1) for number in range(1, 11)]
PARAMETERS = 60
SERVO = common.MavCmd.DO_SET_SERVO


def fly(address: Address, engine: Engine) -> None:
    engine.add(HeartbeatSender(address, common.MavType.QUADROTOR, common.MavAutopilot.PX4))
    commands = engine.add(CommandServer(address))
    commands.support(SERVO, lambda _: common.MavResult.ACCEPTED)
    telemetry = engine.add(MessageServer(address, commands))
    telemetry.provide(common.Attitude, lambda _: common.Attitude(roll=1), interval=0.5)
    telemetry.provide(common.GlobalPositionInt, lambda _: common.GlobalPositionInt(lat=1), interval=1)
    parameters = engine.add(ParameterServer(address))
    for number in range(PARAMETERS):
        parameters.add(f"P_{number}", number * 100 + address.system)
    engine.add(MissionServer(address))


class Fleet:
    """Ten vehicles, and a ground station with its operations."""

    def __init__(self, medium: SharedMedium, share: float | None) -> None:
        self.medium = medium
        self.network = Network(7)
        self.ground = self.network.node(GROUND, self.setup)
        self.vehicles: list[Node] = [
            self.network.node(address, lambda engine, address=address: fly(address, engine))
            for address in VEHICLES
        ]
        self.radios = radio_network(self.network, medium, self.ground, self.vehicles, share)
        self.commands: list = []

    def setup(self, engine: Engine) -> None:
        self.discovery = engine.add(Discovery(GROUND))
        engine.add(HeartbeatSender(GROUND))
        self.command_clients = [engine.add(CommandClient(GROUND, address)) for address in VEHICLES]
        self.parameter_clients = [engine.add(ParameterClient(GROUND, address)) for address in VEHICLES]
        self.mission_clients = [engine.add(MissionClient(GROUND, address)) for address in VEHICLES]

    def command_a_vehicle(self) -> None:
        client = self.command_clients[len(self.commands) % len(VEHICLES)]
        started_at = self.network.now
        self.commands.append(
            (started_at, client.command(Command(SERVO, param1=len(self.commands)), started_at))
        )
        self.ground.engine.touch(client)


@pytest.mark.parametrize(("share", "status"), [(None, True), (5760 / 13, False)])
def test_ten_vehicles_share_a_slow_radio(share: float | None, status: bool) -> None:
    fleet = Fleet(SharedMedium(sends_status=status), share)
    network, ground = fleet.network, fleet.ground
    network.run(timeout=10)
    call_every(network, 1.0, fleet.command_a_vehicle)
    listing = [client.download(network.now, idle_timeout=60.0) for client in fleet.parameter_clients]
    items = [MissionItem(common.MavCmd.NAV_WAYPOINT, param5=47.0, param6=8.0 + step) for step in range(20)]
    plans = [client.upload(Plan.of(items), network.now) for client in fleet.mission_clients]
    for client in (*fleet.parameter_clients, *fleet.mission_clients):
        ground.engine.touch(client)
    started_at = network.now
    assert network.run(lambda: all(operation.done for operation in (*listing, *plans)), timeout=120)
    took = network.now - started_at
    for address, operation in zip(VEHICLES, listing, strict=True):
        values = {name: parameter.value for name, parameter in operation.result().items()}
        assert values == {f"P_{number}": number * 100 + address.system for number in range(PARAMETERS)}
    assert all(len(operation.result()) == len(items) for operation in plans)
    # No vehicle was lost, and every command was answered during the transfers.
    assert not ground.events_of(ComponentLost)
    answered = [operation for _, operation in fleet.commands if operation.done]
    assert len(answered) >= took - 5
    assert all(operation.error is None for operation in answered)
    print(f"{took:.1f} s, {sum(radio.overflowed for radio in fleet.radios)} packets overflowed")
