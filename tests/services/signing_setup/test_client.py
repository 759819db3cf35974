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
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, run_timers, sent_by

NEW = SigningKey.from_passphrase("new")


class SettingClient:
    """A client that asks for a key, and a vehicle that says what the test says."""

    def __init__(self, key=NEW):
        self.client = SigningSetupClient(GROUND, VEHICLE)
        self.operation = self.client.install(key, START)
        self.encoder = Encoder(1, 1, signing=NEW.signing())

    def unsigned(self, message, now):
        deliver(self.client, message, VEHICLE, now)

    def signed(self, message, now):
        self.client.receive(Packet(self.encoder.encode(message, now), common), now)

    def sent(self, until, kind):
        return [message for _, message in run_timers(self.client, until) if isinstance(message, kind)]


def test_requests_are_repeated_until_the_new_way_is_received():
    setting = SettingClient()
    assert not setting.sent(START + 3, common.SetupSigning)  # no packet was received yet
    setting.unsigned(common.Heartbeat(), START + 3)
    asked = setting.sent(START + 30, common.SetupSigning)
    assert 2 <= len(asked) <= 17
    assert {message.secret_key for message in asked} == {NEW.secret_bytes()}
    stamps = [message.initial_timestamp for message in asked]
    assert stamps == sorted(stamps)
    assert stamps[0] == timestamp_at(START + 3)


def test_once_the_new_way_is_received_it_asks_no_more_and_wants_an_answer():
    setting = SettingClient()
    setting.unsigned(common.Heartbeat(), START)
    setting.sent(START, common.SetupSigning)
    setting.signed(common.Heartbeat(), START + 0.1)
    assert setting.client.events() == [ListenForKey(VEHICLE, NEW), UseNewKey(VEHICLE)]
    messages = [message for _, message in run_timers(setting.client, START + 0.6)]
    (proof,) = messages
    assert isinstance(proof, common.Timesync)
    assert not setting.operation.done
    setting.signed(common.Timesync(tc1=5, ts1=proof.ts1 + 1), START + 0.7)  # another component's answer
    assert not setting.operation.done
    setting.signed(common.Timesync(tc1=5, ts1=proof.ts1), START + 0.8)
    assert setting.operation.result() is None
    assert KeySettled(VEHICLE, NEW, changed=True) in setting.client.events()


def test_an_answer_given_the_old_way_proves_nothing_and_it_asks_again():
    setting = SettingClient()
    setting.unsigned(common.Heartbeat(), START)
    setting.sent(START, common.SetupSigning)
    setting.signed(common.Heartbeat(), START + 0.1)
    (proof,) = setting.sent(START + 0.6, common.Timesync)
    setting.unsigned(common.Timesync(tc1=5, ts1=proof.ts1), START + 0.7)
    assert not setting.operation.done
    assert setting.client.changing
    assert setting.client.events()[-1] == UseOldKey(VEHICLE)
    assert setting.sent(START + 1.2, common.SetupSigning)


def test_an_answer_to_what_was_requested_the_old_way_proves_nothing():
    setting = SettingClient()
    setting.unsigned(common.Heartbeat(), START)
    early = setting.sent(START, common.Timesync)
    setting.signed(common.Heartbeat(), START + 0.1)
    for message in early:
        setting.signed(common.Timesync(tc1=5, ts1=message.ts1), START + 0.2)
    assert not setting.operation.done


def test_no_signing_is_requested_by_zeros_and_the_time_zero():
    setting = SettingClient(key=None)
    setting.signed(common.Heartbeat(), START)
    for number in range(1, 4):
        setting.signed(common.Heartbeat(), START + number / 10)
    (message,) = setting.sent(START + 0.4, common.SetupSigning)
    assert (message.secret_key, message.initial_timestamp) == (bytes(32), 0)
    setting.client.receive(Packet(Encoder(1, 1).encode(common.Heartbeat()), common), START + 0.5)
    assert UseNewKey(VEHICLE) in setting.client.events()


def test_a_request_is_addressed_to_the_one_component():
    setting = SettingClient()
    setting.unsigned(common.Heartbeat(), START)
    setting.client.handle_timeout(START)
    for outgoing in setting.client.messages_to_send(START):
        assert outgoing.target == VEHICLE
        assert (outgoing.message.target_system, outgoing.message.target_component) == VEHICLE
    assert sent_by(setting.client, START) == []
