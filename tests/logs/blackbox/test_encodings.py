"""The encodings of Blackbox frames: what the firmware writes is what is read."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.logs.blackbox.encodings import READERS, read_tag8_4s16_v1
from tests.logs.blackbox import writer

INT32 = st.integers(-(2**31), 2**31 - 1) | st.integers(-40, 40) | st.integers(-300, 300)
INT16 = st.integers(-(2**15), 2**15 - 1) | st.integers(-9, 9) | st.just(0)
CASES = (
    (writer.SIGNED, st.lists(INT32, min_size=1, max_size=5)),
    (writer.UNSIGNED, st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=5)),
    (writer.NEGATIVE, st.lists(st.integers(-8191, 8192), min_size=1, max_size=3)),
    (writer.SVB8, st.lists(INT32 | st.just(0), min_size=1, max_size=8)),
    (writer.S32, st.lists(INT32, min_size=3, max_size=3)),
    (writer.S16, st.lists(INT16, min_size=4, max_size=4)),
    (writer.VARIABLE, st.lists(INT32, min_size=3, max_size=3)),
)


@pytest.mark.parametrize(("encoding", "strategy"), CASES, ids=[str(case[0]) for case in CASES])
def test_what_is_written_is_read(encoding, strategy):
    @given(strategy, st.binary(max_size=3))
    def check(values, rest):
        data = writer.encoded(values, [encoding] * len(values))
        found = []
        end = READERS[encoding](b"xy" + data + rest, 2, len(values), found)
        assert (found, end) == (values, 2 + len(data))

    check()


@pytest.mark.parametrize("encoding", sorted(READERS))
def test_a_cut_value_raises(encoding):
    count = {writer.S32: 3, writer.VARIABLE: 3, writer.S16: 4, writer.SVB8: 2}.get(encoding, 1)
    if encoding == writer.NOTHING:
        return
    data = writer.encoded([30_000] * count, [encoding] * count) if encoding != writer.NEGATIVE else b"\xff"
    with pytest.raises(IndexError):
        READERS[encoding](data[:-1], 0, count, [])


def test_a_number_that_is_too_long_is_zero():
    found = []
    assert READERS[writer.UNSIGNED](b"\xff" * 9, 0, 1, found) == 5
    assert found == [0]


def test_groups_of_data_version_1():
    found = []
    # sizes 0, 4 and 4, 16 bits: a pair of 4-bit numbers is one byte, the first one in its low half
    assert read_tag8_4s16_v1(bytes([0b11_01_01_00, 0x2F, 0x34, 0x12]), 0, 4, found) == 4
    assert found == [0, -1, 2, 0x1234]
