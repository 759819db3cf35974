"""Values in 128 bytes."""

from __future__ import annotations

from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.extended_parameters.value import decode, encode, field_of, read_value, with_field

KIND = common.MavParamExtType
CASES = [
    (KIND.UINT8, 200, "<B"),
    (KIND.INT8, -100, "<b"),
    (KIND.UINT16, 60000, "<H"),
    (KIND.INT16, -30000, "<h"),
    (KIND.UINT32, 1 << 31, "<I"),
    (KIND.INT32, -5, "<i"),
    (KIND.UINT64, 1 << 63, "<Q"),
    (KIND.INT64, -(1 << 62), "<q"),
    (KIND.REAL32, 0.5, "<f"),
    (KIND.REAL64, 0.1, "<d"),
]


@pytest.mark.parametrize(("kind", "value", "layout"), CASES)
def test_numbers_lie_as_their_own_bytes(kind, value, layout) -> None:
    data = encode(value, kind)
    assert data == pack(layout, value).ljust(128, b"\0")
    assert decode(data, kind) == value


@given(st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=32))
def test_text_comes_back(text) -> None:
    assert decode(encode(text, KIND.CUSTOM), KIND.CUSTOM) == text


def test_128_characters_have_no_nul() -> None:
    text = "x" * 128
    assert decode(encode(text, KIND.CUSTOM), KIND.CUSTOM) == text
    with pytest.raises(InvalidArgumentError):
        encode(text + "x", KIND.CUSTOM)


def test_what_is_no_text_is_bytes() -> None:
    for data in (b"\xff\xfe", b"a\0b"):
        assert decode(encode(data, KIND.CUSTOM), KIND.CUSTOM) == data


@given(st.binary(min_size=128, max_size=128), st.integers(0, 255))
def test_any_bytes_are_some_value(data, kind) -> None:
    assert isinstance(decode(data, kind), int | float | str | bytes)


@pytest.mark.parametrize(
    ("value", "kind"), [(256, KIND.UINT8), (1.5, KIND.INT32), ("x", KIND.INT32), (1, KIND.CUSTOM), (1, 99)]
)
def test_what_a_type_cannot_hold_raises(value, kind) -> None:
    with pytest.raises(InvalidArgumentError):
        encode(value, kind)


@pytest.mark.parametrize("kind", [common.ParamExtValue, common.ParamExtSet, common.ParamExtAck])
@given(data=st.binary(min_size=128, max_size=128))
def test_the_field_is_the_message_field(kind, data) -> None:
    message = with_field(kind(param_id="ABCDEFGHIJKLMNOP", param_type=KIND.CUSTOM), data)
    assert field_of(message) == data
    assert message.param_id == "ABCDEFGHIJKLMNOP"
    assert message.param_type == KIND.CUSTOM
    plain = kind(param_id="A", param_value="text", param_type=KIND.CUSTOM)
    assert field_of(plain) == b"text".ljust(128, b"\0")


def test_a_value_message_is_read() -> None:
    message = common.ParamExtValue(
        param_id="MODE", param_value="video", param_type=KIND.CUSTOM, param_count=3, param_index=2
    )
    parameter = read_value(message)
    assert (parameter.name, parameter.value, parameter.index) == ("MODE", "video", 2)
