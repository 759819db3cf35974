from __future__ import annotations

import json
from math import inf, nan
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.core.plain_json import MAX_REQUEST, json_bytes, parse_object, plain
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.telemetry.values import Position

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=4),
    max_leaves=20,
)


@given(VALUES)
def test_any_value_is_strict_json(value: Any) -> None:
    assert json.loads(json_bytes(value), parse_constant=pytest.fail) == plain(value)


def test_values_of_the_api() -> None:
    assert plain(Position(1.0, nan)) == {
        "latitude": 1.0,
        "longitude": None,
        "altitude": None,
        "relative_altitude": None,
        "heading": None,
    }
    assert plain(common.MavState.ACTIVE) == "ACTIVE"
    assert plain(common.MavModeFlag.SAFETY_ARMED) == 128
    assert plain([inf, b"\x01", {1: common.MavState.ACTIVE}]) == [None, [1], {"1": "ACTIVE"}]


def test_a_request_is_an_object() -> None:
    assert parse_object(b"") == {}
    assert parse_object(b'{"altitude": null}') == {"altitude": None}


@pytest.mark.parametrize("text", ["NaN", "-Infinity", "1e999"])
def test_numbers_of_a_request_are_finite(text: str) -> None:
    with pytest.raises(InvalidArgumentError, match="finite"):
        parse_object(f'{{"altitude": {text}}}'.encode())


@given(st.binary())
def test_other_bytes_are_refused(data: bytes) -> None:
    try:
        found = parse_object(data)
    except InvalidArgumentError:
        return
    assert isinstance(found, dict)


def test_limits() -> None:
    with pytest.raises(InvalidArgumentError, match="at most"):
        parse_object(b" " * (MAX_REQUEST + 1))
    with pytest.raises(InvalidArgumentError, match="not JSON"):
        parse_object(b"[" * 100_000)
    with pytest.raises(InvalidArgumentError, match="must be a JSON object"):
        parse_object(b"[]")


def test_a_lone_surrogate_is_an_escape() -> None:
    assert json.loads(json_bytes({"text": "\ud800"})) == {"text": "\ud800"}
