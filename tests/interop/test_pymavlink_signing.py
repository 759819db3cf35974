"""Signed links with pymavlink: its `mavutil` as a ground station, our node as the vehicle."""

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
from tests.interop.pymavlink_peer import PATIENCE, connection_to, in_thread, receive, say_hello

pytestmark = pytest.mark.interop

KEY, OTHER = SigningKey.from_passphrase("ours"), SigningKey.from_passphrase("theirs")
SERVO, ACCEPTED = mavlink.MAV_CMD_DO_SET_SERVO, mavlink.MAV_RESULT_ACCEPTED


@asynccontextmanager
async def vehicle_with(key: SigningKey | None):
    """A vehicle that sets a servo, and that anybody who is heard may give a key."""
    link = open_link("udpin://127.0.0.1:0")
    vehicle = Node(link, system=1, component=1, autopilot=common.MavAutopilot.PX4, signing=key)
    vehicle.on_command(SERVO)(lambda request: common.MavResult.ACCEPTED)
    vehicle.serve(SigningSetupServer(vehicle.address, key=key, may_set=lambda request: None))
    async with vehicle:
        yield vehicle, link.address[1]


def set_servo(connection) -> int:
    connection.mav.command_long_send(1, 1, SERVO, 0, 1, 1500, 0, 0, 0, 0, 0)
    return receive(connection, "COMMAND_ACK").result


def assert_all_was_signed_well(connection) -> None:
    signing = connection.mav.signing
    assert signing.goodsig_count > 0
    assert (signing.badsig_count, signing.unsigned_count, signing.reject_count) == (0, 0, 0)


async def test_both_sign_with_one_key() -> None:
    def work(connection):
        for _ in range(3):
            assert set_servo(connection) == ACCEPTED
        assert_all_was_signed_well(connection)

    async with vehicle_with(KEY) as (vehicle, port):
        async with vehicle.packets(system=250) as packets:
            await in_thread(port, work, KEY)
            heard = packets.take()
        assert {packet.name for packet in heard} == {"HEARTBEAT", "COMMAND_LONG"}
        assert all(packet.signed for packet in heard)


@pytest.mark.parametrize(("key", "counter"), [(None, "unsigned"), (OTHER, "forged")])
async def test_without_the_key_it_is_not_heard(key: SigningKey | None, counter: str) -> None:
    def work(port: int) -> None:
        with closing(connection_to(port, key)) as connection:
            for _ in range(5):
                connection.mav.command_long_send(1, 1, SERVO, 0, 1, 1500, 0, 0, 0, 0, 0)

    async with vehicle_with(KEY) as (vehicle, port):
        await asyncio.to_thread(work, port)
        async with asyncio.timeout(PATIENCE):
            while not vehicle.engine.channels or refused(vehicle, counter) < 6:  # noqa: ASYNC110 (no event)
                await asyncio.sleep(0.01)
        assert vehicle.components == {}


def refused(vehicle: Node, counter: str) -> int:
    return getattr(vehicle.engine.channels[0].signing.refusals, counter)


async def test_it_gives_the_vehicle_a_key_and_takes_it_away() -> None:
    def send_key(connection, key: SigningKey | None) -> None:
        secret = list(key.secret_bytes()) if key else [0] * 32
        connection.mav.setup_signing_send(1, 1, secret, timestamp_at(time()) if key else 0)

    def settle(connection, *, signed: bool) -> None:
        """When the vehicle speaks the new way, what a ground station sends every second ends the trial."""
        receive(connection, "HEARTBEAT", lambda heartbeat: heartbeat.get_signed() == signed)
        say_hello(connection)
        assert set_servo(connection) == ACCEPTED

    def work(connection):
        assert set_servo(connection) == ACCEPTED
        send_key(connection, KEY)
        connection.setup_signing(KEY.secret_bytes())
        settle(connection, signed=True)
        assert_all_was_signed_well(connection)
        send_key(connection, None)
        connection.disable_signing()
        settle(connection, signed=False)

    async with vehicle_with(None) as (vehicle, port), vehicle.events(KeySettled) as settled:
        await in_thread(port, work)
        assert [(event.key, event.changed) for event in settled.take()] == [(KEY, True), (None, True)]
        assert vehicle.engine.channels[0].signing is None
