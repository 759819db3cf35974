"""The log that blocks make: complete messages, gaps as dropouts, duplicates ignored."""

from __future__ import annotations

from struct import pack, unpack_from

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.services.log_streaming import HEADER_SIZE, MAGIC, LogAssembler
from mavstack.services.log_streaming.framing import BLOCK_SIZE, NO_START, message_starts

HEADER = MAGIC + bytes(HEADER_SIZE - len(MAGIC))


def message(content: bytes) -> bytes:
    return pack("<HB", len(content), ord("D")) + content


def blocks_of(log: bytes, first: int = 0) -> list[tuple[int, bytes, int]]:
    """Cut a log into numbered blocks with the offsets of their first messages."""
    starts = message_starts(log, HEADER_SIZE)
    blocks = []
    for number, begin in enumerate(range(0, len(log), BLOCK_SIZE)):
        data = log[begin : begin + BLOCK_SIZE]
        inside = [start - begin for start in starts if 0 <= start - begin < len(data)]
        blocks.append(((first + number) % 65536, data, inside[0] if inside else NO_START))
    return blocks


def messages_in(log: bytes) -> list[bytes]:
    found, place = [], HEADER_SIZE
    while place < len(log):
        size = 3 + unpack_from("<H", log, place)[0]
        found.append(log[place : place + size])
        place += size
    assert place == len(log), "the last message is cut"
    return found


CONTENTS = st.lists(st.binary(max_size=700), max_size=20)


@given(CONTENTS, st.sampled_from([0, 65_530]))
def test_all_blocks_give_the_log(contents, first):
    log = HEADER + b"".join(message(content) for content in contents)
    assembler = LogAssembler()
    found = [assembler.add(*block, now=0.0) for block in blocks_of(log, first)]
    assert b"".join(each.data for each in found) == log
    assert {each.lost for each in found} == {0}
    assert assembler.size == len(log)


@given(CONTENTS, st.data())
def test_a_log_with_gaps_is_valid(contents, data):
    """Messages that arrived whole are kept, in order; each gap leaves one dropout message."""
    log = HEADER + b"".join(message(content) for content in contents)
    blocks = blocks_of(log)
    lost = data.draw(st.sets(st.integers(1, max(len(blocks) - 1, 1)), max_size=len(blocks) - 1))
    assembler, result, missing = LogAssembler(), b"", 0
    for block in blocks:
        if block[0] not in lost:
            found = assembler.add(*block, now=float(block[0]))
            result += found.data
            missing += found.lost
    last = max(set(range(len(blocks))) - lost)
    assert missing == len([number for number in lost if number < last])
    kept = [each for each in messages_in(result) if each[2:3] != b"O"]
    sent = iter(messages_in(log))
    assert all(each in sent for each in kept), "messages in order"
    assert (b"O" in {each[2:3] for each in messages_in(result)}) == bool(missing)


def test_duplicates_and_blocks_of_the_past_are_ignored():
    log = HEADER + message(bytes(600))
    assembler, blocks = LogAssembler(), blocks_of(log)
    result = b"".join(assembler.add(*block, now=0.0).data for block in [*blocks[:2], blocks[0], *blocks[1:]])
    assert result == log
    assert not assembler.is_new(0)


def test_nothing_before_the_header_counts():
    assembler = LogAssembler()
    assert assembler.add(7, message(b"old"), 0, 0.0) == (b"", 0)
    assert assembler.add(0, HEADER, NO_START, 0.0).data == HEADER
    found = assembler.add(2, message(b"new"), 0, 1.25)
    assert found.data == pack("<HBH", 2, ord("O"), 1250) + message(b"new")


@pytest.mark.parametrize("data", [b"", b"ULog", b"\xff" * 249])
def test_junk_is_no_header(data):
    assert LogAssembler().add(0, data, 0, 0.0).data == b""


@given(st.lists(st.tuples(st.integers(0, 65535), st.binary(max_size=249), st.integers(0, 255))))
def test_any_blocks_leave_whole_messages(blocks):
    assembler = LogAssembler()
    result = assembler.add(0, HEADER, NO_START, 0.0).data
    for block in blocks:
        result += assembler.add(*block, now=0.0).data
    messages_in(result)
