"""An attacker without the key tries to take the place of a signed vehicle, and to receive its next key."""

from __future__ import annotations

import asyncio
import socket

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, SigningError
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.services import Address
from mavstack.services.signing_setup import SigningSetupServer
from mavstack.vehicle.connection import connect
from mavstack.wire import Encoder, Parser

OLD, NEW = SigningKey.from_passphrase("old"), SigningKey.from_passphrase("new")
VEHICLE = Address(1, 1)
RADIO_STATUS = common.RadioStatus(txbuf=100, rssi=200)
HEARTBEAT = common.Heartbeat(
    type=common.MavType.QUADROTOR,
    autopilot=common.MavAutopilot.PX4,
    base_mode=common.MavModeFlag.SAFETY_ARMED,
)


class Attacker:
    """A UDP socket without the key that sends to the ground station and records what it receives."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self._encoders: dict[Address, Encoder] = {}

    def send(self, message, source: Address = VEHICLE) -> None:
        encoder = self._encoders.setdefault(source, Encoder(*source))
        self.socket.sendto(encoder.encode(message), ("127.0.0.1", self.port))

    def received(self) -> list[str]:
        parser, names = Parser(common), []
        while True:
            try:
                names += [packet.name for packet in parser.feed(self.socket.recv(65535))]
            except BlockingIOError:
                return names

    def received_bytes(self) -> bytes:
        data = b""
        while True:
            try:
                data += self.socket.recv(65535)
            except BlockingIOError:
                return data

    def __enter__(self):
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()


async def vehicle_node(port: int, key) -> Node:
    node = Node(f"udpout://127.0.0.1:{port}", system=1, component=1, autopilot=3, type=2, signing=key)
    node.serve(SigningSetupServer(VEHICLE, key=key, may_set=lambda _: None))
    return await node.open()


async def evict_routes(attacker: Attacker) -> None:
    """Send RADIO_STATUS, which needs no signature, from more addresses than the table of routes holds."""
    for number in range(4200):
        attacker.send(RADIO_STATUS, Address(2 + number // 250, 1 + number % 250))
        if number % 50 == 0:
            await asyncio.sleep(0.002)
    for _ in range(20):
        attacker.send(RADIO_STATUS)
        await asyncio.sleep(0.01)


async def test_forged_radio_status_takes_no_route_and_receives_no_key():
    async with connect("udpin://127.0.0.1:0", signing=OLD) as ground:
        port = ground.links[0].address[1]
        vehicle = await vehicle_node(port, OLD)
        try:
            found = await ground.wait_for_vehicle(timeout=10)
            with Attacker(port) as attacker:
                await evict_routes(attacker)
                attacker.received()
                await found.component.setup_signing(NEW, timeout=20)
                for _ in range(5):
                    attacker.send(RADIO_STATUS)
                    found.component.send(common.CommandLong(command=400))
                    await asyncio.sleep(0.01)
                assert NEW.secret_bytes() not in (data := attacker.received_bytes())
                assert not {packet.name for packet in Parser(common).feed(data)} & {
                    "SETUP_SIGNING",
                    "COMMAND_LONG",
                }
            assert found.latest(common.RadioStatus) is None
            assert set(ground.components) == {VEHICLE}
            assert len(ground._host.engine.routes._routes) == 1
        finally:
            await vehicle.close()


@pytest.mark.flight
async def test_a_living_vehicle_is_not_kept_alive_by_forged_packets():
    async with connect("udpin://127.0.0.1:0", signing=OLD) as ground:
        port = ground.links[0].address[1]
        vehicle = await vehicle_node(port, OLD)
        found = await ground.wait_for_vehicle(timeout=10)
        await vehicle.close()
        with Attacker(port) as attacker:
            for _ in range(70):
                attacker.send(HEARTBEAT)
                attacker.send(RADIO_STATUS)
                await asyncio.sleep(0.1)
            assert not found.alive
            assert not found.armed


async def test_a_key_set_on_one_channel_protects_the_vehicle_on_all():
    """After a first key, unsigned packets of the vehicle's address over a new port are refused."""
    async with connect("udpin://127.0.0.1:0") as ground:
        port = ground.links[0].address[1]
        vehicle = await vehicle_node(port, None)
        try:
            found = await ground.wait_for_vehicle(timeout=10)
            channel = ground.links[0].channels[0]
            await found.component.setup_signing(OLD, channel=channel, timeout=20)
            await asyncio.sleep(0.2)
            with Attacker(port) as attacker:
                for _ in range(30):
                    attacker.send(HEARTBEAT)
                    await asyncio.sleep(0.1)
                attacker.received()
                assert not found.armed
                await found.component.setup_signing(NEW, timeout=20)
                found.component.send(common.CommandLong(command=400))
                await asyncio.sleep(0.1)
                assert NEW.secret_bytes() not in (data := attacker.received_bytes())
                assert "COMMAND_LONG" not in {packet.name for packet in Parser(common).feed(data)}
        finally:
            await vehicle.close()


async def test_a_first_key_needs_a_channel_that_the_program_names():
    async with connect("udpin://127.0.0.1:0") as ground:
        port = ground.links[0].address[1]
        with Attacker(port) as attacker:
            for _ in range(3):  # the attacker was heard first, with the address of the vehicle
                attacker.send(HEARTBEAT)
                await asyncio.sleep(0.02)
            vehicle = await vehicle_node(port, None)
            try:
                await asyncio.sleep(0.5)
                component = ground.component(1)
                with pytest.raises(
                    SigningError, match=r"setting a signing key on 1/1 failed: .*channel='udpin"
                ):
                    await component.setup_signing(NEW, timeout=5)
                with pytest.raises(
                    InvalidArgumentError, match="no open channel is named 'cable'; open channels"
                ):
                    await component.setup_signing(NEW, channel="cable")
                with pytest.raises(SigningError, match="sending a signing key to 1/1 failed"):
                    ground.send(
                        common.SetupSigning(
                            target_system=1, target_component=1, secret_key=NEW.secret_bytes()
                        )
                    )
                own = next(
                    channel
                    for channel in ground.links[0].channels
                    if channel.peer != f"127.0.0.1:{attacker.socket.getsockname()[1]}"
                )
                setting = asyncio.ensure_future(component.setup_signing(NEW, channel=own, timeout=30))
                while not setting.done():
                    attacker.send(HEARTBEAT)
                    await asyncio.sleep(0.05)
                await setting
                assert NEW.secret_bytes() not in attacker.received_bytes()
                await asyncio.sleep(0.3)
                states = {state.name: state.signing for state in ground._host.engine.channels}
                assert states[own.name] is not None
            finally:
                await vehicle.close()


@pytest.mark.flight
async def test_a_vehicle_that_returns_over_another_port_keeps_its_key():
    async with connect("udpin://127.0.0.1:0") as ground:
        port = ground.links[0].address[1]
        vehicle = await vehicle_node(port, None)
        found = await ground.wait_for_vehicle(timeout=10)
        await found.component.setup_signing(OLD, channel=ground.links[0].channels[0], timeout=20)
        await vehicle.close()
        vehicle = await vehicle_node(port, OLD)
        try:
            await asyncio.sleep(4)
            await found.component.ping(1, timeout=5)
            states = [state.signing for state in ground._host.engine.channels]
            assert len(states) == 2
            assert None not in states
        finally:
            await vehicle.close()
