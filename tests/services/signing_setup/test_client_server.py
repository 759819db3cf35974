"""Setting keys between two ends: confirmed, or rolled back, and never cut off."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, RemoteCancelled, RemoteDenied, RemoteTimeout, SigningError
from mavstack.security import SigningKey
from mavstack.services import BROADCAST, Address, Service, message_ids
from mavstack.services.signing_setup import (
    KeySettled,
    SetupSigning,
    SigningRefused,
    SigningSetupClient,
    SigningSetupServer,
)
from mavstack.services.signing_setup.key_change import MIN_PROOF_PACKETS, KeyChange
from mavstack.wire import Encoder, Packet
from tests.services.network import GROUND, START, VEHICLE
from tests.services.signing_setup.harness import SigningHarness

OLD, NEW = SigningKey.from_passphrase("old"), SigningKey.from_passphrase("new")


@pytest.mark.parametrize(("old", "new"), [(None, NEW), (OLD, NEW), (OLD, None)])
def test_a_key_is_set_changed_and_taken_away(old, new):
    harness = SigningHarness(key=old)
    operation = harness.run(harness.install(new))
    assert operation.result() is None
    assert harness.server.key == new
    assert harness.network.now < START + 3.0
    harness.assert_heartbeats_arrive()
    assert harness.signed == (new is not None,) * 2
    for node in (harness.ground, harness.vehicle):
        (settled,) = node.events_of(KeySettled)
        assert (settled.key, settled.changed) == (new, True)
    if new is not None:
        assert all(port.channel.signing for node in harness.network.nodes for port in node.ports)
        assert harness.ground.ports[0].channel._other is None


def test_afterwards_the_old_way_is_refused():
    harness = SigningHarness()
    harness.run(harness.install(NEW))
    harness.network.run(timeout=2.0)
    channel = harness.vehicle.ports[0].channel
    data = harness.ground.ports[0].channel
    data.signing = None
    before = channel.signing.refusals.unsigned
    harness.network.run(timeout=5.0)
    assert channel.signing.refusals.unsigned > before


def test_a_refused_setup_leaves_neither_side_deaf():
    harness = SigningHarness(key=OLD, policy=lambda request: "armed")
    operation = harness.run(harness.install(NEW))
    assert isinstance(operation.error, RemoteDenied)
    assert harness.server.key == OLD
    assert harness.vehicle.events_of(SigningRefused)[0].reason == "armed"
    assert any("armed" in p.message.text for p in harness.ground.received if p.name == "STATUSTEXT")
    harness.assert_heartbeats_arrive()
    assert [event.changed for event in harness.ground.events_of(KeySettled)] == [False]


@pytest.mark.parametrize("trusted", [True, False])
def test_by_default_only_a_trusted_channel_may_set_keys(trusted):
    harness = SigningHarness(trusted=trusted)
    operation = harness.run(harness.install(NEW))
    assert (operation.error is None) is trusted
    harness.assert_heartbeats_arrive()


def test_without_a_policy_no_client_may():
    harness = SigningHarness()
    harness.vehicle.engine.remove(harness.server)
    server = harness.vehicle.engine.add(SigningSetupServer(VEHICLE))
    assert isinstance(harness.run(harness.install(NEW)).error, RemoteDenied)
    assert server.key is None


def test_one_that_ignores_the_message_leaves_neither_side_deaf():
    harness = SigningHarness(key=OLD)
    harness.vehicle.engine.remove(harness.server)
    assert isinstance(harness.run(harness.install(NEW)).error, RemoteDenied)
    harness.assert_heartbeats_arrive()


def test_one_that_takes_the_key_but_cannot_hear_us_goes_back_and_so_do_we():
    harness = SigningHarness(key=OLD)
    operation = harness.install(NEW)
    assert harness.network.run(lambda: harness.server.on_trial, timeout=5.0)
    there, _ = harness.pipes
    there.cut = True  # the component sends, but receives nothing
    harness.network.at(12.0, lambda: setattr(there, "cut", False))
    harness.run(operation)
    harness.network.run(timeout=30.0)
    assert isinstance(operation.error, RemoteDenied)
    assert harness.server.key == OLD
    harness.assert_heartbeats_arrive()
    assert not harness.client.changing


def test_one_that_took_the_key_while_we_received_nothing_is_followed():
    """The operation gives up, the vehicle has changed: we speak its way as soon as we hear it."""
    harness = SigningHarness(key=OLD)
    operation = harness.install(NEW, timeout=5.0)
    assert harness.network.run(
        lambda: harness.client._change and harness.client._change.uses_new, timeout=5.0
    )
    _, back = harness.pipes
    back.cut = True
    harness.run(operation)
    assert isinstance(operation.error, RemoteTimeout)
    assert harness.server.key == NEW
    assert harness.client.changing
    back.cut = False
    harness.network.run(timeout=30.0)
    assert [event.changed for event in harness.ground.events_of(KeySettled)] == [True]
    harness.assert_heartbeats_arrive()


def test_a_vehicle_that_answers_no_timesync_is_believed_after_its_trial():
    harness = SigningHarness(answers=False)
    assert harness.run(harness.install(NEW)).error is None
    assert harness.server.key == NEW
    harness.assert_heartbeats_arrive()


def test_a_vehicle_without_a_trial_as_ardupilot_is_confirmed_too():
    class SendsImmediately(Service):
        handles = message_ids(common.SetupSigning)

        def receive(self, packet, now):
            channel = harness.vehicle.engine.arrived_on
            key = SigningKey(packet.message.secret_key)
            channel.signing = key.signing(3, timestamp=packet.message.initial_timestamp)

    harness = SigningHarness(key=OLD)
    harness.vehicle.engine.remove(harness.server)
    harness.vehicle.engine.add(SendsImmediately(VEHICLE))
    assert harness.run(harness.install(NEW)).error is None
    harness.assert_heartbeats_arrive()


def test_nothing_is_sent_before_the_target_is_received_nor_to_others():
    harness = SigningHarness()
    other_vehicle = harness.network.node(Address(9, 9))
    harness.network.connect(harness.ground, other_vehicle)
    there, back = harness.pipes
    there.cut = back.cut = True
    operation = harness.install(NEW)
    harness.network.run(timeout=3.0)
    assert operation.attempts == 0
    there.cut = back.cut = False
    assert harness.run(operation).error is None
    assert [p for p in harness.vehicle.received if p.name == "SETUP_SIGNING"]
    assert not [p for p in other_vehicle.received if p.name == "SETUP_SIGNING"]


def test_silence_is_a_timeout_and_changes_nothing():
    harness = SigningHarness(key=OLD)
    for pipe in harness.pipes:
        pipe.cut = True
    assert isinstance(harness.run(harness.install(NEW)).error, RemoteTimeout)
    for pipe in harness.pipes:
        pipe.cut = False
    harness.assert_heartbeats_arrive()


def test_cancelling_half_way_leaves_neither_side_deaf():
    harness = SigningHarness(key=OLD)
    operation = harness.install(NEW)
    assert harness.network.run(lambda: harness.server.on_trial, timeout=5.0)
    harness.client.cancel(operation, harness.network.now)
    harness.ground.engine.touch(harness.client)
    assert isinstance(operation.error, RemoteCancelled)
    harness.network.run(timeout=40.0)
    assert not harness.client.changing
    harness.assert_heartbeats_arrive()
    second = harness.run(harness.install(OLD))
    assert second.error is None
    harness.assert_heartbeats_arrive()


def test_a_second_change_waits_until_the_first_is_settled():
    harness = SigningHarness()
    first, second = harness.install(OLD), harness.install(NEW)
    harness.run(second)
    assert first.error is None
    assert second.error is None
    assert harness.server.key == NEW
    harness.assert_heartbeats_arrive()


def test_a_damaged_signature_is_not_taken_for_the_old_way():
    change = KeyChange(VEHICLE, NEW, lambda event: None)
    encoder = Encoder(1, 1, signing=NEW.signing())
    good = encoder.encode(common.Heartbeat(), START)
    change.observe(Packet(good, common), START)
    assert change.uses_new
    for number in range(MIN_PROOF_PACKETS):
        assert change.uses_new
        damaged = bytearray(encoder.encode(common.Heartbeat(), START + number))
        damaged[-1] ^= 1
        change.observe(Packet(bytes(damaged), common), START + number)
    assert not change.uses_new


def test_the_same_key_again_is_confirmed_without_asking():
    harness = SigningHarness(key=OLD)
    operation = harness.run(harness.install(OLD))
    assert operation.error is None
    assert operation.attempts == 0
    harness.assert_heartbeats_arrive()


def test_a_key_shows_in_no_text():
    harness = SigningHarness()
    operation = harness.run(harness.install(NEW))
    secret = NEW.secret_bytes()
    texts = [repr(operation.__dict__), operation.description, repr(harness.server.__dict__)]
    texts += [repr(event) for node in harness.network.nodes for _, event in node.events]
    texts += [repr(p.message) for p in harness.vehicle.received]
    assert any("SetupSigning" in text for text in texts)
    for text in texts:
        assert secret.hex() not in text
        assert repr(secret)[2:-1] not in text


def test_our_own_misuse_raises_at_once():
    for target in (BROADCAST, Address(1, 0), Address(0, 1)):
        with pytest.raises(InvalidArgumentError, match="one component"):
            SigningSetupClient(GROUND, target)
    with pytest.raises(SigningError, match="zeros"):
        SetupSigning(SigningKey(bytes(32)))
