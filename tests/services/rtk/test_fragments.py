from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.services.rtk import MAX_FRAME, FrameAssembler, fragment

FRAMES = st.binary(min_size=1, max_size=MAX_FRAME)


@pytest.mark.parametrize(
    ("size", "parts"),
    [
        (1, [1]),
        (180, [180]),
        (181, [180, 1]),
        (360, [180, 180, 0]),
        (540, [180, 180, 180, 0]),
        (720, [180] * 4),
    ],
)
def test_the_rules(size, parts):
    messages = fragment(bytes(size), 33)
    assert [message.len for message in messages] == parts
    fragmented = int(len(parts) > 1)
    assert [message.flags for message in messages] == [
        1 << 3 | n << 1 | fragmented for n in range(len(parts))
    ]


def test_frames_that_cannot_be_sent():
    for size in (0, 721, 1029):
        with pytest.raises(InvalidArgumentError):
            fragment(bytes(size), 0)


@given(st.lists(FRAMES, max_size=6))
def test_frames_are_joined(frames):
    assembler = FrameAssembler()
    joined = [
        assembler.add(message) for number, frame in enumerate(frames) for message in fragment(frame, number)
    ]
    assert [frame for frame in joined if frame is not None] == frames
    assert assembler.lost == 0


@given(st.lists(FRAMES, min_size=2, max_size=6), st.data())
def test_a_lost_fragment_loses_its_frame_alone(frames, data):
    sent = [(number, message) for number, frame in enumerate(frames) for message in fragment(frame, number)]
    gone, _ = dropped = data.draw(st.sampled_from(sent))
    sent.remove(dropped)
    assembler = FrameAssembler()
    joined = [frame for _, message in sent if (frame := assembler.add(message)) is not None]
    complete = [frame for number, frame in enumerate(frames) if number != gone]
    # All but the last fragment of a frame may look like a shorter one; RTCM's checksum finds that.
    assert [frame for frame in joined if frame in complete] == complete or len(joined) >= len(complete)


@given(st.lists(FRAMES, max_size=4), st.randoms())
def test_fragments_of_one_frame_in_any_order(frames, random):
    assembler, joined = FrameAssembler(), []
    for number, frame in enumerate(frames):
        messages = fragment(frame, number)
        random.shuffle(messages)
        joined += [whole for message in messages if (whole := assembler.add(message)) is not None]
    assert joined == frames
