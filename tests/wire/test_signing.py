"""Signing compared with pymavlink, and over time: which packets each side accepts."""

from __future__ import annotations

import hashlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as peer

import mavstack
from mavstack.dialects import common
from mavstack.security import SigningKey
from mavstack.security.timestamps import timestamp_at

KEY = hashlib.sha256(b"a test").digest()
NOW = 1_750_000_000.0

timestamps = st.integers(1, 2**48 - 5)
#: A parser without a time refuses packets far ahead of the system's clock.
past_timestamps = st.integers(1, timestamp_at(NOW))


def their_link(timestamp, link_id=0, key=KEY, system=1, component=1):
    link = peer.MAVLink(None, srcSystem=system, srcComponent=component)
    link.signing.secret_key = key
    link.signing.sign_outgoing = True
    link.signing.link_id = link_id
    link.signing.timestamp = timestamp
    return link


def attitude(link):
    return peer.MAVLink_attitude_message(1, 0.5, 0.25, 0.125, 0, 0, 0).pack(link)


OURS = common.Attitude(1, 0.5, 0.25, 0.125)


@given(st.binary(min_size=32, max_size=32), st.integers(0, 255), timestamps, st.integers(0, 255))
def test_signatures_equal_those_of_pymavlink(key, link_id, timestamp, system):
    link = their_link(timestamp, link_id, key, system=system)
    signing = mavstack.Signing(key, link_id, timestamp=timestamp - 1)
    encoder = mavstack.Encoder(system, 1, signing=signing)
    for number in range(3):
        link.seq = number
        ours = encoder.encode(OURS)
        assert ours == attitude(link)
        assert ours[2] == 1
    assert signing.timestamp == timestamp + 2


@given(timestamps, st.integers(0, 255))
def test_pymavlink_accepts_our_packets_and_refuses_replayed_or_changed_ones(timestamp, link_id):
    link = their_link(0)
    raw = mavstack.encode(
        OURS, system=9, component=8, signing=mavstack.Signing(KEY, link_id, timestamp=timestamp - 1)
    )
    (read,) = link.parse_buffer(raw)
    assert (read.get_signed(), read.get_link_id(), read.roll) == (True, link_id, 0.5)
    for wrong in (raw, raw[:-1] + bytes([raw[-1] ^ 1])):
        with pytest.raises(peer.MAVError, match="signature"):
            link.parse_buffer(wrong)


@given(past_timestamps, st.integers(0, 255), st.integers(0, 27), st.integers(1, 255))
def test_we_accept_packets_of_pymavlink_and_refuse_replayed_or_changed_ones(
    timestamp, link_id, position, change
):
    raw = attitude(their_link(timestamp, link_id))
    signing = mavstack.Signing(KEY, 5)
    parser = mavstack.Parser(common, signing=signing)
    (packet,) = parser.feed(raw)
    assert (packet.signed, packet.link_id, packet.signature_timestamp) == (True, link_id, timestamp)
    assert packet.signature == raw[-13:]
    assert signing.timestamp == timestamp
    assert parser.feed(raw) == []
    assert signing.refusals.replayed == 1
    forged = bytearray(raw)
    forged[-1 - position % 13] ^= change
    fresh = mavstack.Signing(KEY)
    assert mavstack.Parser(common, signing=fresh).feed(forged) == []
    assert (fresh.refusals.forged, fresh.refusals.total, fresh.streams, fresh.timestamp) == (1, 1, 0, 0)


def test_both_sides_exchange_signed_packets():
    ours, theirs = mavstack.Signing(KEY, 1, timestamp=1000), their_link(500, 2, system=255)
    parser, encoder = mavstack.Parser(common, signing=ours), mavstack.Encoder(1, 1, signing=ours)
    for _ in range(50):
        (read,) = theirs.parse_buffer(encoder.encode(OURS))
        assert read.get_signed()
        (packet,) = parser.feed(attitude(theirs))
        assert packet.signed
    assert ours.refusals.total == 0
    assert (ours.streams, theirs.signing.badsig_count) == (1, 0)


def test_a_wrong_key_does_not_block_the_right_one():
    """Pymavlink stores the timestamp before it checks the hash, so a forged packet blocks its stream."""
    forged = attitude(their_link(2**48 - 2, key=bytes(32)))
    valid = attitude(their_link(1000))
    theirs = their_link(0)
    with pytest.raises(peer.MAVError):
        theirs.parse_buffer(forged)
    with pytest.raises(peer.MAVError):
        theirs.parse_buffer(valid)
    parser = mavstack.Parser(common, signing=mavstack.Signing(KEY))
    assert parser.feed(forged) == []
    assert len(parser.feed(valid)) == 1


def test_the_age_limit_of_a_new_stream_equals_that_of_pymavlink():
    now = timestamp_at(NOW)
    for behind, accepted in ((6_000_000, True), (6_000_001, False)):
        raw = attitude(their_link(now - behind))
        theirs = their_link(now)
        if accepted:
            assert theirs.parse_buffer(raw)
        else:
            with pytest.raises(peer.MAVError):
                theirs.parse_buffer(raw)
        for signing, time in ((mavstack.Signing(KEY, timestamp=now), None), (mavstack.Signing(KEY), NOW)):
            assert bool(mavstack.Parser(common, signing=signing).feed(raw, time)) is accepted


def test_refused_packets_are_counted_in_the_statistics():
    signing = mavstack.Signing(KEY)
    parser = mavstack.Parser(common, signing=signing)
    unsigned = mavstack.encode(OURS, system=1, component=1)
    parser.feed(
        unsigned
        + attitude(their_link(10))
        + attitude(their_link(9))
        + attitude(their_link(20, key=bytes(32)))
    )
    refusals = signing.refusals
    assert (refusals.unsigned, refusals.replayed, refusals.forged, refusals.total) == (1, 1, 1, 3)
    assert (parser.statistics.packets, parser.statistics.signed) == (4, 3)


def test_one_state_for_both_directions_of_a_link():
    signing = SigningKey(KEY).signing(3, accept_unsigned=False)
    parser, encoder = mavstack.Parser(common, signing=signing), mavstack.Encoder(1, 1, signing=signing)
    assert parser.signing is encoder.signing is signing
    parser.feed(attitude(their_link(5000)))
    raw = encoder.encode(OURS)
    assert int.from_bytes(raw[-12:-6], "little") == 5001, "received timestamps advance the clock of sent ones"
    (packet,) = mavstack.Parser(common).feed(raw)
    assert packet.link_id == 3


@pytest.mark.parametrize(
    "policy",
    [{"max_streams": -1}, {"link_id": 256}, {"timestamp": -1}, {"timestamp": 2**48}, {"unsigned_ids": ["x"]}],
)
def test_invalid_policies_are_refused(policy):
    with pytest.raises((ValueError, TypeError, OverflowError)):
        mavstack.Signing(KEY, **policy)


def test_invalid_times_are_refused():
    signing = mavstack.Signing(KEY)
    with pytest.raises(ValueError, match="time"):
        mavstack.encode(OURS, system=1, component=1, signing=signing, now=float("inf"))
    assert signing.timestamp == 0
