from __future__ import annotations

from math import inf, isnan, nan
from struct import pack, unpack

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.files.parameters.numbers import agree, as_single, read_number, rounds_to, write_number

KIND = common.MavParamType
singles = st.floats(width=32)


@given(singles)
@example(0.1)
@example(-0.0)
@example(16777216.0)
@example(3.4028234663852886e38)
@example(1e-45)
def test_a_float_reads_back_to_the_same_float32(value):
    back = read_number(write_number(value))
    assert pack("<f", back) == pack("<f", value) or (isnan(back) and isnan(value))


@given(st.floats(width=32, allow_nan=False, allow_infinity=False, min_value=2.0**-100, max_value=2.0**24))
def test_no_shorter_number_reads_back(value):
    """NumPy writes the shortest digits that are unique among float32; ours are no more.

    Whole floats are written as integers, which beyond this range may have more digits.
    """
    ours = write_number(value)
    shortest = np.format_float_scientific(np.float32(value), unique=True, trim="-")
    digits = len(shortest.partition("e")[0].replace(".", ""))
    assert len(ours.partition("e")[0].replace(".", "").strip("0")) <= digits


@given(st.integers(-(1 << 63), (1 << 64) - 1))
def test_integers_are_exact(value):
    back = read_number(write_number(value))
    assert (back, type(back)) == (value, int)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1500", 1500),
        ("-1", -1),
        ("+7", 7),
        ("0x1F", 31),
        ("-0x10", -16),
        ("0.135000", 0.135),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e-3", 0.001),
        ("Inf", inf),
    ],
)
def test_numbers_as_programs_write_them(text, value):
    assert (read_number(text), type(read_number(text))) == (value, type(value))


@pytest.mark.parametrize(
    "text", ["", "abc", "1,5", "1_000", "--1", "0x", "1e", "٣", "1 2", "9" * 65, "e5", "0b1", "1.5f"]
)
def test_texts_that_are_no_numbers(text):
    assert read_number(text) is None


def test_whole_floats_are_written_as_integers():
    assert [write_number(value) for value in (1500.0, 1e6, -2.0, 0.0, 5, True)] == [
        "1500",
        "1000000",
        "-2",
        "0",
        "5",
        "1",
    ]
    assert [write_number(value) for value in (0.1, unpack("<f", pack("<f", 7.1))[0], 1e-5)] == [
        "0.1",
        "7.1",
        "1e-05",
    ]
    assert write_number(-0.0) == "-0.0"
    assert write_number(nan) == "nan"


def test_integers_agree_as_integers_where_the_type_is_one():
    assert not agree(16777216, 16777217, kind=KIND.INT32)
    assert not agree(16777216, 16777217)
    assert agree(16777216, 16777217, kind=KIND.REAL32)
    assert agree(16777216, 16777217, kind=KIND.INT32, exact=False)
    assert agree(1500.0, 1500, kind=KIND.INT16)
    assert not agree(1500.4, 1500, kind=KIND.INT16)


@given(singles)
def test_a_float_agrees_with_itself_and_its_text(value):
    assert agree(value, value)
    assert agree(float(write_number(value)), value, kind=KIND.REAL32)


@given(st.floats(-1e6, 1e6, width=32))
def test_values_rounded_by_other_programs_agree(value):
    six_decimals = f"{value:f}"
    assert float(six_decimals) == read_number(six_decimals)
    assert agree(read_number(six_decimals), value) or rounds_to(value, six_decimals)
    seven_digits = f"{value:.7g}"
    if isinstance(read_number(seven_digits), float):
        assert rounds_to(value, seven_digits)


def test_values_that_no_program_writes_do_not_agree():
    assert not rounds_to(0.1235, "0.1234")
    assert not rounds_to(0.1234567, "0.123456")
    assert not rounds_to(0.5, "1")
    assert not rounds_to(nan, "0.000000")
    assert rounds_to(1e-7, "0.000000")
    assert not rounds_to(1e-7, "0.0")


def test_values_too_large_for_a_float32():
    assert as_single(1e300) == inf
    assert write_number(1e300) == "inf"
