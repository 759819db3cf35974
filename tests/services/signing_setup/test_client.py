"""The signing setup client alone, packet by packet."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.security import SigningKey
from mavstack.security.timestamps import timestamp_at
from mavstack.services.signing_setup import (
    KeySettled,
    ListenForKey,
    SigningSetupClient,
    UseNewKey,
    UseOldKey,
)
from mavstack.wire import Encoder, Packet
from tests.services.drive import give, pass_time, sent
from tests.services.network import GROUND, START, VEHICLE

NEW = SigningKey.from_passphrase("new")


class Asker:
    """A client that asks for a key, and a vehicle that says what the test says."""

    def __init__(self, key=NEW):
        self.client = SigningSetupClient(GROUND, VEHICLE)
        self.operation = self.client.install(key, START)
        self.encoder = Encoder(1, 1, signing=NEW.signing())

    def unsigned(self, message, now):
        give(self.client, message, VEHICLE, now)

    def signed(self, message, now):
        self.client.receive(Packet(self.encoder.encode(message, now), common), now)

    def sent(self, until, kind):
        return [message for _, message in pass_time(self.client, until) if isinstance(message, kind)]


def test_requests_are_repeated_until_the_new_way_is_received():
    asker = Asker()
    assert not asker.sent(START + 3, common.SetupSigning)  # no packet was received yet
    asker.unsigned(common.Heartbeat(), START + 3)
    asked = asker.sent(START + 30, common.SetupSigning)
    assert 2 <= len(asked) <= 17
    assert {message.secret_key for message in asked} == {NEW.secret_bytes()}
    stamps = [message.initial_timestamp for message in asked]
    assert stamps == sorted(stamps)
    assert stamps[0] == timestamp_at(START + 3)


def test_once_the_new_way_is_received_it_asks_no_more_and_wants_an_answer():
    asker = Asker()
    asker.unsigned(common.Heartbeat(), START)
    asker.sent(START, common.SetupSigning)
    asker.signed(common.Heartbeat(), START + 0.1)
    assert asker.client.events() == [ListenForKey(VEHICLE, NEW), UseNewKey(VEHICLE)]
    messages = [message for _, message in pass_time(asker.client, START + 0.6)]
    (proof,) = messages
    assert isinstance(proof, common.Timesync)
    assert not asker.operation.done
    asker.signed(common.Timesync(tc1=5, ts1=proof.ts1 + 1), START + 0.7)  # another component's answer
    assert not asker.operation.done
    asker.signed(common.Timesync(tc1=5, ts1=proof.ts1), START + 0.8)
    assert asker.operation.result() is None
    assert KeySettled(VEHICLE, NEW, changed=True) in asker.client.events()


def test_an_answer_given_the_old_way_proves_nothing_and_it_asks_again():
    asker = Asker()
    asker.unsigned(common.Heartbeat(), START)
    asker.sent(START, common.SetupSigning)
    asker.signed(common.Heartbeat(), START + 0.1)
    (proof,) = asker.sent(START + 0.6, common.Timesync)
    asker.unsigned(common.Timesync(tc1=5, ts1=proof.ts1), START + 0.7)
    assert not asker.operation.done
    assert asker.client.changing
    assert asker.client.events()[-1] == UseOldKey(VEHICLE)
    assert asker.sent(START + 1.2, common.SetupSigning)


def test_an_answer_to_what_was_requested_the_old_way_proves_nothing():
    asker = Asker()
    asker.unsigned(common.Heartbeat(), START)
    early = asker.sent(START, common.Timesync)
    asker.signed(common.Heartbeat(), START + 0.1)
    for message in early:
        asker.signed(common.Timesync(tc1=5, ts1=message.ts1), START + 0.2)
    assert not asker.operation.done


def test_no_signing_is_requested_by_zeros_and_the_time_zero():
    asker = Asker(key=None)
    asker.signed(common.Heartbeat(), START)
    for number in range(1, 4):
        asker.signed(common.Heartbeat(), START + number / 10)
    (message,) = asker.sent(START + 0.4, common.SetupSigning)
    assert (message.secret_key, message.initial_timestamp) == (bytes(32), 0)
    asker.client.receive(Packet(Encoder(1, 1).encode(common.Heartbeat()), common), START + 0.5)
    assert UseNewKey(VEHICLE) in asker.client.events()


def test_a_request_is_addressed_to_the_one_component():
    asker = Asker()
    asker.unsigned(common.Heartbeat(), START)
    asker.client.handle_timeout(START)
    for outgoing in asker.client.messages_to_send(START):
        assert outgoing.target == VEHICLE
        assert (outgoing.message.target_system, outgoing.message.target_component) == VEHICLE
    assert sent(asker.client, START) == []
