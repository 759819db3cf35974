"""Boundaries of messages in the bytes of a log."""

from __future__ import annotations

from struct import pack

from hypothesis import given
from hypothesis import strategies as st

from mavstack.services.log_streaming.framing import dropout, message_starts, whole_messages


def message(content: bytes) -> bytes:
    return pack("<HB", len(content), ord("D")) + content


@given(st.lists(st.binary(max_size=300)), st.integers(0, 400))
def test_a_cut_leaves_whole_messages(contents, kept):
    messages = [message(content) for content in contents]
    data = b"".join(messages)[:kept]
    ends = [0]
    for each in messages:
        ends.append(ends[-1] + len(each))
    assert whole_messages(data) == max(end for end in ends if end <= len(data))
    assert message_starts(data) == [end for end in ends if end < len(data)]


def test_the_length_of_a_gap_is_in_milliseconds():
    assert dropout(1.5) == pack("<HBH", 2, ord("O"), 1500)
    assert dropout(0) == pack("<HBH", 2, ord("O"), 1)
    assert dropout(1000)[-2:] == b"\xff\xff"
