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
from tests.services.signing_setup.pair import Pair

OLD, NEW = SigningKey.from_passphrase("old"), SigningKey.from_passphrase("new")


@pytest.mark.parametrize(("old", "new"), [(None, NEW), (OLD, NEW), (OLD, None)])
def test_a_key_is_set_changed_and_taken_away(old, new):
    pair = Pair(key=old)
    operation = pair.run(pair.install(new))
    assert operation.result() is None
    assert pair.server.key == new
    assert pair.network.now < START + 3.0
    pair.assert_they_hear_each_other()
    assert pair.signed == (new is not None,) * 2
    for node in (pair.ground, pair.vehicle):
        (settled,) = node.events_of(KeySettled)
        assert (settled.key, settled.changed) == (new, True)
    if new is not None:
        assert all(port.channel.signing for node in pair.network.nodes for port in node.ports)
        assert pair.ground.ports[0].channel._other is None


def test_afterwards_the_old_way_is_refused():
    pair = Pair()
    pair.run(pair.install(NEW))
    pair.network.run(timeout=2.0)
    channel = pair.vehicle.ports[0].channel
    data = pair.ground.ports[0].channel
    data.signing = None
    before = channel.signing.refusals.unsigned
    pair.network.run(timeout=5.0)
    assert channel.signing.refusals.unsigned > before


def test_a_refused_setup_leaves_neither_side_deaf():
    pair = Pair(key=OLD, policy=lambda request: "armed")
    operation = pair.run(pair.install(NEW))
    assert isinstance(operation.error, RemoteDenied)
    assert pair.server.key == OLD
    assert pair.vehicle.events_of(SigningRefused)[0].reason == "armed"
    assert any("armed" in p.message.text for p in pair.ground.heard if p.name == "STATUSTEXT")
    pair.assert_they_hear_each_other()
    assert [event.changed for event in pair.ground.events_of(KeySettled)] == [False]


@pytest.mark.parametrize("trusted", [True, False])
def test_by_default_only_a_trusted_channel_may_set_keys(trusted):
    pair = Pair(trusted=trusted)
    operation = pair.run(pair.install(NEW))
    assert (operation.error is None) is trusted
    pair.assert_they_hear_each_other()


def test_without_a_policy_no_client_may():
    pair = Pair()
    pair.vehicle.engine.remove(pair.server)
    server = pair.vehicle.engine.add(SigningSetupServer(VEHICLE))
    assert isinstance(pair.run(pair.install(NEW)).error, RemoteDenied)
    assert server.key is None


def test_one_that_ignores_the_message_leaves_neither_side_deaf():
    pair = Pair(key=OLD)
    pair.vehicle.engine.remove(pair.server)
    assert isinstance(pair.run(pair.install(NEW)).error, RemoteDenied)
    pair.assert_they_hear_each_other()


def test_one_that_takes_the_key_but_cannot_hear_us_goes_back_and_so_do_we():
    pair = Pair(key=OLD)
    operation = pair.install(NEW)
    assert pair.network.run(lambda: pair.server.on_trial, timeout=5.0)
    there, _ = pair.pipes
    there.cut = True  # the component sends, but receives nothing
    pair.network.at(12.0, lambda: setattr(there, "cut", False))
    pair.run(operation)
    pair.network.run(timeout=30.0)
    assert isinstance(operation.error, RemoteDenied)
    assert pair.server.key == OLD
    pair.assert_they_hear_each_other()
    assert not pair.client.changing


def test_one_that_took_the_key_while_we_received_nothing_is_followed():
    """The operation gives up, the vehicle has changed: we speak its way as soon as we hear it."""
    pair = Pair(key=OLD)
    operation = pair.install(NEW, timeout=5.0)
    assert pair.network.run(lambda: pair.client._change and pair.client._change.uses_new, timeout=5.0)
    _, back = pair.pipes
    back.cut = True
    pair.run(operation)
    assert isinstance(operation.error, RemoteTimeout)
    assert pair.server.key == NEW
    assert pair.client.changing
    back.cut = False
    pair.network.run(timeout=30.0)
    assert [event.changed for event in pair.ground.events_of(KeySettled)] == [True]
    pair.assert_they_hear_each_other()


def test_a_vehicle_that_answers_no_timesync_is_believed_after_its_trial():
    pair = Pair(answers=False)
    assert pair.run(pair.install(NEW)).error is None
    assert pair.server.key == NEW
    pair.assert_they_hear_each_other()


def test_a_vehicle_without_a_trial_as_ardupilot_is_confirmed_too():
    class AtOnce(Service):
        handles = message_ids(common.SetupSigning)

        def receive(self, packet, now):
            channel = pair.vehicle.engine.arrived_on
            key = SigningKey(packet.message.secret_key)
            channel.signing = key.signing(3, timestamp=packet.message.initial_timestamp)

    pair = Pair(key=OLD)
    pair.vehicle.engine.remove(pair.server)
    pair.vehicle.engine.add(AtOnce(VEHICLE))
    assert pair.run(pair.install(NEW)).error is None
    pair.assert_they_hear_each_other()


def test_nothing_is_sent_before_the_target_is_received_nor_to_others():
    pair = Pair()
    stranger = pair.network.node(Address(9, 9))
    pair.network.connect(pair.ground, stranger)
    there, back = pair.pipes
    there.cut = back.cut = True
    operation = pair.install(NEW)
    pair.network.run(timeout=3.0)
    assert operation.attempts == 0
    there.cut = back.cut = False
    assert pair.run(operation).error is None
    assert [p for p in pair.vehicle.heard if p.name == "SETUP_SIGNING"]
    assert not [p for p in stranger.heard if p.name == "SETUP_SIGNING"]


def test_silence_is_a_timeout_and_changes_nothing():
    pair = Pair(key=OLD)
    for pipe in pair.pipes:
        pipe.cut = True
    assert isinstance(pair.run(pair.install(NEW)).error, RemoteTimeout)
    for pipe in pair.pipes:
        pipe.cut = False
    pair.assert_they_hear_each_other()


def test_cancelling_half_way_leaves_neither_side_deaf():
    pair = Pair(key=OLD)
    operation = pair.install(NEW)
    assert pair.network.run(lambda: pair.server.on_trial, timeout=5.0)
    pair.client.cancel(operation, pair.network.now)
    pair.ground.engine.touch(pair.client)
    assert isinstance(operation.error, RemoteCancelled)
    pair.network.run(timeout=40.0)
    assert not pair.client.changing
    pair.assert_they_hear_each_other()
    second = pair.run(pair.install(OLD))
    assert second.error is None
    pair.assert_they_hear_each_other()


def test_a_second_change_waits_until_the_first_is_settled():
    pair = Pair()
    first, second = pair.install(OLD), pair.install(NEW)
    pair.run(second)
    assert first.error is None
    assert second.error is None
    assert pair.server.key == NEW
    pair.assert_they_hear_each_other()


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
    pair = Pair(key=OLD)
    operation = pair.run(pair.install(OLD))
    assert operation.error is None
    assert operation.attempts == 0
    pair.assert_they_hear_each_other()


def test_a_key_shows_in_no_text():
    pair = Pair()
    operation = pair.run(pair.install(NEW))
    secret = NEW.secret_bytes()
    texts = [repr(operation.__dict__), operation.description, repr(pair.server.__dict__)]
    texts += [repr(event) for node in pair.network.nodes for _, event in node.events]
    texts += [repr(p.message) for p in pair.vehicle.heard]
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
