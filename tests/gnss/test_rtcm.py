from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.gnss.rtcm import RtcmFrame, RtcmFramer, crc24q

PAYLOADS = st.binary(min_size=2, max_size=1023)


def msm(number: int, epoch: int, size: int = 100) -> RtcmFrame:
    """A frame with the header of a multiple signal message."""
    head = (number << 42 | 7 << 30 | epoch) << 2
    return RtcmFrame.of(head.to_bytes(7, "big") + bytes(size - 7))


def station(number: int = 1005) -> RtcmFrame:
    return RtcmFrame.of((number << 4).to_bytes(2, "big") + bytes(17))


def test_the_example_of_the_standard():
    frame = bytes.fromhex("D300133ED7D30202980EDEEF34B4BD62AC0941986F33360B98")
    assert RtcmFramer().feed(frame) == [RtcmFrame(1005, frame)]
    assert crc24q(frame) == 0


@given(PAYLOADS)
def test_frames_are_those_of_pyrtcm(payload):
    from pyrtcm.rtcmhelpers import calc_crc24q

    frame = RtcmFrame.of(payload)
    assert calc_crc24q(frame.data) == 0
    assert calc_crc24q(payload) == crc24q(payload)
    assert frame.number == int.from_bytes(payload[:2], "big") >> 4


@given(st.lists(st.one_of(PAYLOADS, st.just(None)), max_size=6), st.data())
def test_frames_survive_junk_and_any_cut(payloads, data):
    stream, expected = b"", []
    for payload in payloads:
        if payload is None:
            stream += data.draw(st.binary(max_size=40)).replace(b"\xd3", b"")
        else:
            expected.append(RtcmFrame.of(payload))
            stream += expected[-1].data
    framer, found = RtcmFramer(), []
    while stream:
        size = data.draw(st.integers(1, len(stream)))
        found += framer.feed(stream[:size])
        stream = stream[size:]
    assert found == expected


@given(st.lists(st.binary(max_size=300), max_size=10))
def test_any_bytes_are_accepted(chunks):
    framer = RtcmFramer()
    for chunk in chunks:
        for frame in framer.feed(chunk):
            assert crc24q(frame.data) == 0
            assert frame.epoch is None or frame.is_msm


def test_a_false_preamble_hides_no_frame():
    framer = RtcmFramer()
    assert framer.feed(b"\xd3\x00\x04" + station().data + bytes(8)) == [station()]
    assert framer.bad_frames == 1


def test_epochs_and_kinds():
    assert msm(1074, 123_456_789).epoch == 123_456_789
    assert msm(1074, 0).is_observation
    assert not station().is_observation
    assert station().epoch is None
    assert RtcmFrame.of(b"\x3e\xc0").is_observation  # 1004
    assert RtcmFrame.of(b"").number == 0


def test_reset_drops_an_incomplete_frame():
    framer = RtcmFramer()
    framer.feed(station().data[:10])
    framer.reset()
    assert framer.bad_bytes == 10
    assert framer.feed(station().data) == [station()]


@pytest.mark.parametrize("bit", [0, 9, 30, 100])
def test_a_changed_bit_is_found(bit):
    data = bytearray(station().data)
    data[bit // 8] ^= 1 << bit % 8
    assert RtcmFramer().feed(bytes(data) + bytes(1100)) == []
