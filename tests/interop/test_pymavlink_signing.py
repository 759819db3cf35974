"""Signed links with pymavlink: `mavutil` as the ground station, a node as the vehicle."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager, closing
from time import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavstack.dialects import common
from mavstack.links import open_link
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.security.timestamps import timestamp_at
from mavstack.services.signing_setup import KeySettled, SigningSetupServer
from tests.interop.pymavlink_peer import connection_to, in_thread, receive, send_heartbeat
from tests.waiting import wait_until

pytestmark = pytest.mark.interop

KEY, OTHER = SigningKey.from_passphrase("ours"), SigningKey.from_passphrase("theirs")
SERVO, ACCEPTED = mavlink.MAV_CMD_DO_SET_SERVO, mavlink.MAV_RESULT_ACCEPTED


@asynccontextmanager
async def vehicle_with(key: SigningKey | None):
    """Yield a vehicle that sets a servo and accepts a signing key."""
    link = open_link("udpin://127.0.0.1:0")
    vehicle = Node(link, system=1, component=1, autopilot=common.MavAutopilot.PX4, signing=key)
    vehicle.on_command(SERVO)(lambda request: common.MavResult.ACCEPTED)
    vehicle.serve(SigningSetupServer(vehicle.address, key=key, may_set=lambda request: None))
    async with vehicle:
        yield vehicle, link.address[1]


def set_servo(connection) -> int:
    connection.mav.command_long_send(1, 1, SERVO, 0, 1, 1500, 0, 0, 0, 0, 0)
    return receive(connection, "COMMAND_ACK").result


def assert_all_signed(connection) -> None:
    signing = connection.mav.signing
    assert signing.goodsig_count > 0
    assert (signing.badsig_count, signing.unsigned_count, signing.reject_count) == (0, 0, 0)


async def test_both_sign_with_one_key() -> None:
    def work(connection):
        for _ in range(3):
            assert set_servo(connection) == ACCEPTED
        assert_all_signed(connection)

    async with vehicle_with(KEY) as (vehicle, port):
        async with vehicle.packets(system=250) as packets:
            await in_thread(port, work, KEY)
            received = packets.drain()
        assert {packet.name for packet in received} == {"HEARTBEAT", "COMMAND_LONG"}
        assert all(packet.signed for packet in received)


@pytest.mark.parametrize(("key", "counter"), [(None, "unsigned"), (OTHER, "forged")])
async def test_packets_without_the_key_are_refused(key: SigningKey | None, counter: str) -> None:
    def work(port: int) -> None:
        with closing(connection_to(port, key)) as connection:
            for _ in range(5):
                connection.mav.command_long_send(1, 1, SERVO, 0, 1, 1500, 0, 0, 0, 0, 0)

    async with vehicle_with(KEY) as (vehicle, port):
        await asyncio.to_thread(work, port)
        await wait_until(lambda: vehicle._host.engine.channels and refused(vehicle, counter) >= 6)
        assert vehicle.components == {}


def refused(vehicle: Node, counter: str) -> int:
    return getattr(vehicle._host.engine.channels[0].signing.refusals, counter)


async def test_setup_and_removal_of_a_key() -> None:
    def send_key(connection, key: SigningKey | None) -> None:
        secret = list(key.secret_bytes()) if key else [0] * 32
        connection.mav.setup_signing_send(1, 1, secret, timestamp_at(time()) if key else 0)

    def settle(connection, *, signed: bool) -> None:
        """Confirm a key change: heartbeats of the ground station end the trial period of the new key."""
        receive(connection, "HEARTBEAT", lambda heartbeat: heartbeat.get_signed() == signed)
        send_heartbeat(connection)
        assert set_servo(connection) == ACCEPTED

    def work(connection):
        assert set_servo(connection) == ACCEPTED
        send_key(connection, KEY)
        connection.setup_signing(KEY.secret_bytes())
        settle(connection, signed=True)
        assert_all_signed(connection)
        send_key(connection, None)
        connection.disable_signing()
        settle(connection, signed=False)

    async with vehicle_with(None) as (vehicle, port), vehicle.events(KeySettled) as settled:
        await in_thread(port, work)
        assert [(event.key, event.changed) for event in settled.drain()] == [(KEY, True), (None, True)]
        assert vehicle._host.engine.channels[0].signing is None
