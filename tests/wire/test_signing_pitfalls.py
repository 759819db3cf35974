"""Pitfalls of signing: frequent errors in articles about MAVLink and in implementations, one test each."""

from __future__ import annotations

import pytest

import mavstack
from mavstack.dialects import ardupilotmega, common
from mavstack.errors import EncodeError, SigningError
from mavstack.security.timestamps import timestamp_at

from . import raw_packets
from .test_pitfalls import KEY, heartbeat

NOW = 1_700_000_000.0


def receiver(**policy):
    return mavstack.Signing(KEY, 0, timestamp=timestamp_at(NOW), **policy)


def accepts(signing, raw, now=NOW):
    return bool(mavstack.Parser(ardupilotmega, signing=signing).feed(raw, now))


def signed_at(timestamp, *, link_id=1, key=KEY, **header):
    return raw_packets.signed(heartbeat(incompat=1, **header), key, link_id, timestamp)


def test_a_forged_packet_from_the_far_future_blocks_no_stream():
    signing, now = receiver(), timestamp_at(NOW)
    assert accepts(signing, signed_at(now))
    assert not accepts(signing, signed_at(2**48 - 1, key=bytes(32)))
    assert signing.refusals.forged == 1
    assert accepts(signing, signed_at(now + 1))
    assert signing.timestamp == now + 1, "the clock does not move"


def test_a_forged_first_packet_creates_no_stream():
    signing = receiver()
    assert not accepts(signing, signed_at(timestamp_at(NOW), key=bytes(32)))
    assert signing.streams == 0


def test_streams_are_distinguished_by_link_system_and_component():
    signing, now = receiver(), timestamp_at(NOW)
    variants = ({}, {"link_id": 2}, {"system": 2}, {"component": 2})
    assert all(accepts(signing, signed_at(now, **variant)) for variant in variants)
    assert signing.streams == 4
    assert not any(accepts(signing, signed_at(now, **variant)) for variant in variants)


def test_the_table_of_streams_is_bounded():
    signing, now = receiver(max_streams=2), timestamp_at(NOW)
    assert [accepts(signing, signed_at(now, component=number)) for number in range(4)] == [
        True,
        True,
        False,
        False,
    ]
    assert signing.refusals.too_many_streams == 2
    assert accepts(signing, signed_at(now + 1, component=0))


def test_replays_and_equal_timestamps_are_refused():
    signing, now = receiver(), timestamp_at(NOW)
    raw = signed_at(now)
    assert accepts(signing, raw)
    assert not accepts(signing, raw)
    assert not accepts(signing, signed_at(now - 1))
    assert signing.refusals.replayed == 2
    assert accepts(signing, signed_at(now + 1))


def test_a_new_stream_may_be_up_to_one_minute_behind_the_clock():
    signing, now = receiver(), timestamp_at(NOW)
    assert not accepts(signing, signed_at(now - 6_000_001))
    assert signing.refusals.stale == 1
    assert accepts(signing, signed_at(now - 6_000_000))


def test_reordered_datagrams_need_a_reorder_slack():
    now = timestamp_at(NOW)
    for slack, expected in ((0.0, False), (0.001, True)):
        signing = receiver(reorder_slack=slack)
        assert accepts(signing, signed_at(now + 50))
        assert accepts(signing, signed_at(now + 10)) is expected
        assert not accepts(signing, signed_at(now + 10))
        assert not accepts(signing, signed_at(now - 100))


def test_the_clock_only_moves_forward():
    signing, now = receiver(), timestamp_at(NOW)
    times = []
    for clock in (NOW + 5, NOW + 1, NOW - 1e6, NOW + 5):
        raw = mavstack.encode(common.Heartbeat(), system=1, component=1, signing=signing, now=clock)
        times.append(int.from_bytes(raw[-12:-6], "little"))
    assert times == [now + 500_000, now + 500_001, now + 500_002, now + 500_003]
    assert signing.timestamp == times[-1]
    assert accepts(signing, signed_at(times[-1] + 100))
    assert signing.timestamp == times[-1] + 100


def test_a_signed_packet_from_the_far_future_does_not_advance_the_clock():
    signing, now = receiver(), timestamp_at(NOW)
    assert not accepts(signing, signed_at(2**48 - 1))
    assert (signing.refusals.future, signing.timestamp) == (1, now)
    assert accepts(signing, signed_at(now + 100))


def test_many_signed_packets_do_not_advance_the_clock_step_by_step():
    signing, now, day = receiver(), timestamp_at(NOW), 24 * 3600 * 100_000
    for step in range(1, 8):
        accepts(signing, signed_at(now + step * day))
    assert signing.timestamp <= now + day


def test_version_1_packets_are_refused_on_a_signed_link():
    signing = receiver()
    assert not accepts(signing, heartbeat(version=1))
    assert not accepts(signing, heartbeat(version=2))
    assert signing.refusals.unsigned == 2
    assert accepts(receiver(accept_unsigned=True), heartbeat(version=1))


def test_version_1_cannot_be_signed():
    with pytest.raises(EncodeError, match="cannot be signed"):
        mavstack.encode(common.Heartbeat(), system=1, component=1, version=1, signing=receiver())
    with pytest.raises(EncodeError):
        mavstack.Encoder(1, 1, version=1, signing=receiver()).encode(common.Heartbeat())


def test_radio_status_may_be_accepted_unsigned():
    radio = mavstack.encode(common.RadioStatus(rssi=9), system=51, component=68, version=1)
    assert not accepts(receiver(), radio)
    signing = receiver(unsigned_ids=[common.RadioStatus.definition.id])
    assert accepts(signing, radio)
    assert not accepts(signing, heartbeat()), "other messages are refused"


def test_a_wrong_key_length_is_refused_without_showing_the_key():
    for wrong in (b"", b"secret-secret", bytes(33)):
        with pytest.raises(SigningError) as failure:
            mavstack.Signing(wrong)
        assert "secret" not in str(failure.value)


def test_the_signed_flag_is_covered_by_the_signature():
    """A signature cannot be removed: its flag is covered by the hash and the CRC."""
    signing, raw = receiver(), signed_at(timestamp_at(NOW))
    assert not accepts(signing, raw[:-13])
    assert not accepts(signing, raw[:2] + b"\0" + raw[3:-13])
