"""Length-prefixed frames."""

from __future__ import annotations

import random

import pytest

from mavstack.errors import LinkError
from mavstack.links.framing import MAX_FRAME, FrameReader, frame


def test_a_frame_begins_with_its_length_in_big_endian_order():
    assert frame(b"\xfd" * 300) == b"\x00\x00\x01\x2c" + b"\xfd" * 300


@pytest.mark.parametrize("seed", range(20))
def test_frames_are_found_in_any_chunks(seed):
    numbers = random.Random(seed)
    contents = [numbers.randbytes(numbers.choice([1, 5, 300, 3000])) for _ in range(20)]
    stream = b"".join(frame(each) + frame(b"") for each in contents)
    reader, found = FrameReader(), []
    while stream:
        size = numbers.randint(1, 700)
        found += reader.feed(stream[:size])
        stream = stream[size:]
    assert found == contents


def test_a_plain_stream_is_recognised():
    with pytest.raises(LinkError, match="the peer does not use framing=length"):
        list(FrameReader().feed(b"\xfd\x09\x00\x00" * 3))
    with pytest.raises(LinkError, match="the peer does not use framing=length"):
        list(FrameReader().feed((MAX_FRAME + 1).to_bytes(4, "big")))
    assert list(FrameReader().feed(MAX_FRAME.to_bytes(4, "big"))) == []
