from __future__ import annotations

from random import Random

import pytest

from mavstack.dialects import common
from mavstack.security import SigningKey
from mavstack.services import Address
from mavstack.services.signing_setup import (
    KeySettled,
    ListenForKey,
    SigningRefused,
    SigningSetupClient,
    SigningSetupServer,
    UseNewKey,
    UseOldKey,
)
from mavstack.wire import Encoder, Packet
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, random_message

ONE, TWO = SigningKey.from_passphrase("one"), SigningKey.from_passphrase("two")


def setup(key: SigningKey | None, timestamp=1000, target=VEHICLE) -> common.SetupSigning:
    return common.SetupSigning(
        target_system=target[0],
        target_component=target[1],
        secret_key=key.secret_bytes() if key else bytes(32),
        initial_timestamp=timestamp,
    )


def signed(message, key, source=GROUND, now=START):
    data = Encoder(source.system, source.component, signing=key.signing()).encode(message, now)
    return Packet(data, common)


def server(**options) -> SigningSetupServer:
    return SigningSetupServer(VEHICLE, may_set=lambda request: None, **options)


def test_a_new_key_is_on_trial_until_it_is_received():
    vehicle = server()
    deliver(vehicle, setup(ONE), GROUND, START)
    assert vehicle.events() == [ListenForKey(GROUND, ONE, 1000), UseNewKey(GROUND)]
    assert vehicle.key is None
    deliver(vehicle, common.Heartbeat(), GROUND, START + 1)
    vehicle.receive(signed(common.Heartbeat(), TWO), START + 1)
    assert vehicle.on_trial
    vehicle.receive(signed(common.Heartbeat(), ONE), START + 2)
    assert vehicle.events() == [KeySettled(GROUND, ONE, changed=True)]
    assert vehicle.key == ONE
    assert vehicle.next_timeout() is None


def test_a_trial_without_an_echo_is_taken_back():
    vehicle = server(key=TWO)
    deliver(vehicle, setup(ONE), GROUND, START)
    vehicle.events()
    vehicle.handle_timeout(START + 9.9)
    assert vehicle.on_trial
    assert vehicle.next_timeout() == START + 10
    vehicle.handle_timeout(START + 10)
    assert vehicle.events() == [UseOldKey(GROUND), KeySettled(GROUND, ONE, changed=False)]
    assert vehicle.key == TWO


def test_another_sender_does_not_end_the_trial():
    vehicle = server()
    deliver(vehicle, setup(ONE), GROUND, START)
    vehicle.receive(signed(common.Heartbeat(), ONE, source=Address(9, 9)), START + 1)
    assert vehicle.on_trial


@pytest.mark.parametrize("target", [(0, 0), (1, 0), (0, 1), (2, 1), (1, 2)])
def test_a_key_for_all_or_for_others_is_not_taken(target):
    vehicle = server()
    deliver(vehicle, setup(ONE, target=target), GROUND, START)
    assert vehicle.events() == []


def test_asking_again_changes_nothing_and_an_reordered_one_neither():
    vehicle = server()
    deliver(vehicle, setup(ONE, 1000), GROUND, START)
    vehicle.events()
    deliver(vehicle, setup(ONE, 1001), GROUND, START + 5, 1)
    deliver(vehicle, setup(TWO, 999), GROUND, START + 6, 2)
    assert vehicle.events() == []
    assert vehicle.next_timeout() == START + 10


def test_a_packet_that_comes_twice_begins_no_second_trial():
    vehicle = server()
    deliver(vehicle, setup(None, 0), GROUND, START)
    deliver(vehicle, setup(ONE, 10), GROUND, START, 1)
    vehicle.receive(signed(common.Heartbeat(), ONE), START + 1)
    deliver(vehicle, setup(None, 0), GROUND, START + 2)  # the first one, from some queue
    assert vehicle.key == ONE
    assert not vehicle.on_trial


def test_another_key_during_a_trial_goes_back_before_it_begins():
    vehicle = server()
    deliver(vehicle, setup(ONE, 1), GROUND, START)
    vehicle.events()
    deliver(vehicle, setup(TWO, 2), GROUND, START + 1, 1)
    assert vehicle.events() == [
        UseOldKey(GROUND),
        KeySettled(GROUND, ONE, changed=False),
        ListenForKey(GROUND, TWO, 2),
        UseNewKey(GROUND),
    ]


def test_zeros_mean_no_signing_only_at_time_zero_as_for_ardupilot():
    vehicle = server(key=ONE)
    deliver(vehicle, setup(None, 5), GROUND, START)
    assert isinstance(vehicle.events()[0], SigningRefused)
    deliver(vehicle, setup(None, 0), GROUND, START, 1)
    assert vehicle.events() == [ListenForKey(GROUND, None), UseNewKey(GROUND)]
    deliver(vehicle, common.Heartbeat(), GROUND, START + 1)
    assert vehicle.events() == [KeySettled(GROUND, None, changed=True)]
    assert vehicle.key is None


@pytest.mark.parametrize("timestamp", [2**48 - 1, 2**48, 2**64 - 1])
def test_a_clock_that_would_soon_end_is_not_taken(timestamp):
    vehicle = server()
    deliver(vehicle, setup(ONE, timestamp), GROUND, START)
    (refused,) = vehicle.events()
    assert isinstance(refused, SigningRefused)
    assert not vehicle.on_trial


def test_without_a_clock_the_new_way_is_recognised():
    vehicle = server()
    deliver(vehicle, setup(ONE), GROUND, 1000.0)
    vehicle.receive(signed(common.Heartbeat(), ONE, now=START), 1001.0)
    assert vehicle.key == ONE


def test_the_policy_knows_who_asks_and_whether_it_was_signed():
    asked = []
    vehicle = SigningSetupServer(VEHICLE, may_set=lambda request: asked.append(request) or "no")
    deliver(vehicle, setup(ONE), GROUND, START)
    vehicle.receive(signed(setup(ONE), TWO), START)
    assert [(request.source, request.disables, request.signed) for request in asked] == [
        (GROUND, False, False),
        (GROUND, False, True),
    ]


def test_garbage_from_the_wire_never_raises():
    random = Random(7)
    vehicle, client = server(), SigningSetupClient(GROUND, VEHICLE)
    for number in range(1000):
        now = START + number
        if not client.busy:
            client.install(ONE, now)
        for _ in range(3):
            message = random_message(
                random.choice([common.SetupSigning, common.Heartbeat, common.Timesync]), random
            )
            if isinstance(message, common.SetupSigning):
                message = message.replace(target_system=1, target_component=1)
            deliver(vehicle, message, GROUND, now, number % 256)
            deliver(client, message, VEHICLE, now, number % 256)
        vehicle.handle_timeout(now)
        client.handle_timeout(now)
    assert len(vehicle._seen) <= 64
