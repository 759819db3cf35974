"""Changes of the key of a channel in use."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.node.channel_state import ChannelState
from mavstack.node.engine import Engine
from mavstack.node.key_change import apply_key_event, trusted_channels
from mavstack.node.signing_states import SigningStates
from mavstack.security import SigningKey
from mavstack.services.signing_setup import (
    KeySettled,
    ListenForKey,
    SigningRequest,
    UseNewKey,
    UseOldKey,
)
from mavstack.wire import Encoder, Packet
from tests.services.network import GROUND, START, VEHICLE

OLD, NEW = SigningKey.from_passphrase("old"), SigningKey.from_passphrase("new")


class Peer:
    """A sender of packets in three signing states: the old key, the new key, or unsigned."""

    def __init__(self):
        self.encoders = {key: Encoder(1, 1, signing=signing) for key, signing in self.signing_states()}

    @staticmethod
    def signing_states():
        return (("old", OLD.signing()), ("new", NEW.signing()), ("none", None))

    def packet(self, state: str) -> bytes:
        return self.encoders[state].encode(common.Heartbeat(), START)


def accepted(channel: ChannelState, peer: Peer) -> set[str]:
    return {state for state in ("old", "new", "none") if channel.receive(peer.packet(state), START)}


def signing_state_of(channel: ChannelState) -> str:
    packet = Packet(channel.encode(common.Heartbeat(), GROUND, START, 0), common)
    for name, key in (("old", OLD), ("new", NEW)):
        other = ChannelState("other", common, signing=key.signing())
        if packet.signed and other.receive(packet.raw, START):
            return name
    return "none"


@pytest.mark.parametrize(("old", "new"), [("old", "new"), ("old", "none"), ("none", "new")])
def test_both_keys_are_accepted_during_a_change_and_one_after_it(old, new):
    keys = {"old": OLD, "new": NEW, "none": None}
    key, peer = keys[old], Peer()
    channel = ChannelState("cable", common, signing=key.signing() if key else None)
    apply_key_event(ListenForKey(VEHICLE, keys[new]), [channel], SigningStates())
    assert {old, new} <= accepted(channel, peer)
    assert signing_state_of(channel) == old
    for event, state in ((UseNewKey(VEHICLE), new), (UseOldKey(VEHICLE), old), (UseNewKey(VEHICLE), new)):
        apply_key_event(event, [channel], SigningStates())
        apply_key_event(event, [channel], SigningStates())  # idempotent
        assert signing_state_of(channel) == state
        assert {old, new} <= accepted(channel, peer)
    apply_key_event(KeySettled(VEHICLE, keys[new], changed=True), [channel], SigningStates())
    assert signing_state_of(channel) == new
    expected = {"old", "new", "none"} if new == "none" else {new}
    assert accepted(channel, peer) == expected


@pytest.mark.parametrize(("timestamp", "clock"), [(0, 10**12), (5, 10**12), (10**13, 10**13)])
def test_timestamps_continue_with_a_new_key(timestamp, clock):
    channel = ChannelState("cable", common, signing=OLD.signing(timestamp=10**12))
    apply_key_event(ListenForKey(VEHICLE, NEW, timestamp), [channel], SigningStates())
    channel.use_new(True)
    assert channel.clock == clock


def test_a_packet_that_both_states_accept_is_delivered_once():
    channel, peer = ChannelState("cable", common), Peer()
    channel.accept_also(NEW.signing())
    assert len(channel.receive(peer.packet("new") + peer.packet("none"), START)) == 2


def test_a_half_received_packet_survives_the_change():
    channel, peer = ChannelState("cable", common, signing=OLD.signing()), Peer()
    channel.accept_also(NEW.signing())
    data = peer.packet("new")
    channel.receive(data[:9], START)
    channel.use_new(True)
    channel.settle()
    assert len(channel.receive(data[9:], START)) == 1


def test_sequence_numbers_continue():
    channel = ChannelState("cable", common)
    channel.accept_also(NEW.signing())
    numbers = []
    for new in (True, True, False, False):
        channel.use_new(new)
        numbers.append(Packet(channel.encode(common.Heartbeat(), GROUND, START, 0), common).sequence)
    assert numbers == [0, 1, 2, 3]


def test_without_a_change_nothing_is_switched():
    channel = ChannelState("cable", common, signing=OLD.signing())
    channel.use_new(True)
    assert signing_state_of(channel) == "old"


def test_radio_status_needs_no_key():
    channel = ChannelState("cable", common)
    apply_key_event(ListenForKey(VEHICLE, NEW), [channel], SigningStates())
    apply_key_event(UseNewKey(VEHICLE), [channel], SigningStates())
    apply_key_event(KeySettled(VEHICLE, NEW, changed=True), [channel], SigningStates())
    radio = Encoder(51, 68)
    assert len(channel.receive(radio.encode(common.RadioStatus(txbuf=50), START), START)) == 1
    assert not channel.receive(radio.encode(common.Heartbeat(), START), START)


def test_the_policy_checks_the_channel_of_the_request():
    engine = Engine(VEHICLE)
    may_set = trusted_channels(engine)
    request = SigningRequest(GROUND, disables=False, signed=False)
    assert may_set(request) is not None
    engine.arrived_on = engine.open_channel("radio")
    assert may_set(request) is not None
    engine.arrived_on.trusted = True
    assert may_set(request) is None
