from __future__ import annotations

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.security.sealed.noise import Suite
from mavstack.security.sealed.session import OVERHEAD, WINDOW, FrameError, Session, slot_of

KEYS = bytes(range(32)), bytes(range(32, 64))


@pytest.fixture(params=[False, True], ids=["ChaCha20", "AES"])
def pair(request):
    return make_pair(request.param)


def make_pair(aes: bool = False) -> tuple[Session, Session]:
    suite = Suite(aes=aes)
    one = Session(suite, KEYS, 2, initiator=True, now=0.0)
    return one, Session(suite, KEYS[::-1], 2, initiator=False, now=0.0)


def accepts(session: Session, frame: bytes) -> bool:
    try:
        session.open(frame)
    except FrameError:
        return False
    return True


def test_a_frame_has_20_bytes_more(pair):
    one, other = pair
    assert OVERHEAD == 20
    for content in (b"", b"x", bytes(1000)):
        frame = one.seal(content)
        assert len(frame) == len(content) + 20
        assert slot_of(frame) == other.slot
        assert other.open(frame) == content
    assert other.open(one.seal(b"a")) == b"a"
    assert one.open(other.seal(b"b")) == b"b"


def test_own_frames_sent_back_belong_to_another_slot(pair):
    one, _ = pair
    frame = one.seal(b"")
    assert slot_of(frame) != one.slot
    assert not accepts(one, frame)


@given(st.integers(0, 2**32))
def test_each_frame_is_accepted_once_in_any_order_within_the_window(seed):
    one, other = make_pair()
    random = Random(seed)
    frames = [one.seal(b"%d" % number) for number in range(60)]
    received = frames * 2
    random.shuffle(received)
    assert sum(accepts(other, frame) for frame in received) == len(frames)


def test_a_frame_behind_the_window_is_refused(pair):
    one, other = pair
    old, frames = one.seal(b"old"), [one.seal(b"") for _ in range(WINDOW)]
    assert accepts(other, frames[-1])
    assert not accepts(other, old)
    assert accepts(other, frames[0])


@given(st.data())
def test_a_changed_frame_is_refused_and_does_not_move_the_window(data):
    one, other = make_pair()
    frame = bytearray(one.seal(b"content"))
    position, bit = data.draw(st.integers(0, len(frame) - 1)), data.draw(st.integers(0, 7))
    frame[position] ^= 1 << bit
    assert not accepts(other, bytes(frame))
    assert accepts(other, one.seal(b"next"))


@pytest.mark.parametrize("start", [2**28 - 3, 2**29 - 2, 2**28 + 2**27 - 1, 2**40 - 1])
def test_the_counter_is_completed_over_its_low_bits(pair, start):
    one, other = pair
    other._top = start - 2**26
    one.sent = start  # many frames were lost
    for _ in range(5):
        assert accepts(other, one.seal(b""))


def test_only_headers_of_the_last_frames_were_sent(pair):
    one, other = pair
    frames = [one.seal(b"") for _ in range(WINDOW + 1)]
    assert one.has_sent(frames[-1][:4])
    assert not one.has_sent(frames[0][:4])
    assert not one.has_sent(other.seal(b"")[:4])
    assert not one.has_sent(bytes(4))


@pytest.mark.parametrize("data", [b"", b"\x80", bytes(20), b"\x80" * 19])
def test_what_is_no_frame(data):
    assert slot_of(data) is None
