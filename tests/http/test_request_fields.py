from __future__ import annotations

from typing import Annotated, Literal

import pytest
from msgspec import Meta

from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields, read_fields, read_query
from mavstack.http.routes import NoFields


class Inner(Fields):
    width: int = 0


class Request(Fields):
    speed: Annotated[float, Meta(description="Metres per second.", ge=0, le=50)]
    count: Annotated[int, Meta(description="A number.", ge=1)] = 3
    force: bool = False
    kind: Literal["a", "b"] | None = None
    mode: int | Annotated[str, Meta(max_length=4096)] | None = None
    file: Annotated[str, Meta(max_length=8, pattern="^[a-z]+$(?!\\n)")] | None = None
    params: Annotated[tuple[float | None, ...], Meta(max_length=2)] = ()
    place: tuple[Annotated[float, Meta(ge=-90, le=90)], float] | None = None
    inner: Inner | None = None


def test_values_and_defaults() -> None:
    found = read_fields(Request, {"speed": 5, "kind": None, "force": None, "mode": 4})
    assert found == Request(speed=5.0, mode=4)
    assert isinstance(found.speed, float)


def test_a_query_has_texts() -> None:
    found = read_query(Request, {"speed": "2.5", "count": "7", "force": "TRUE", "kind": "b"})
    assert found == Request(speed=2.5, count=7, force=True, kind="b")


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({}, "speed is missing: Metres per second."),
        ({"speed": None}, "speed is missing"),
        ({"speed": True}, "speed must be a number from 0 to 50, got True"),
        ({"speed": "5"}, "speed must be a number from 0 to 50, got '5'"),
        ({"speed": 51}, "speed must be a number from 0 to 50, got 51"),
        ({"speed": 10**400}, "speed must be a number from 0 to 50"),
        ({"speed": 1, "count": 1.5}, "count must be an integer of at least 1, got 1.5"),
        ({"speed": 1, "force": 1}, "force must be true or false, got 1"),
        ({"speed": 1, "kind": "c"}, "kind must be one of a, b, got 'c'"),
        ({"speed": 1, "mode": "x" * 4097}, "or a string of at most 4096 characters, got 'x"),
        (
            {"speed": 1, "file": "abcdefghi"},
            "file must be a string of at most 8 characters that fits ^[a-z]+$",
        ),
        ({"speed": 1, "file": "ab\n"}, "file must be a string of at most 8 characters"),
        ({"speed": 1, "mode": []}, "mode must be an integer or a string of at most 4096 characters, got []"),
        ({"speed": 1, "params": ["x"]}, "params must be an array of at most 2 values, each a number"),
        (
            {"speed": 1, "place": [91, 8]},
            "place must be an array of 2 values, each a number from -90 to 90 and a number, got [91, 8]",
        ),
        ({"speed": 1, "inner": 5}, "inner must be an object, got 5"),
        ({"speed": 1, "sped": 2}, "there is no field 'sped': did you mean speed?"),
        ({"speed": 1, "x" * 5000: 2}, "…: there are speed, count, force, kind, mode, file, params, place"),
    ],
)
def test_wrong_values_are_refused_with_a_reason(values, problem) -> None:
    with pytest.raises(RefusedError) as caught:
        read_fields(Request, values)
    assert problem in str(caught.value)
    assert caught.value.status == 400


def test_a_request_without_fields_takes_none() -> None:
    with pytest.raises(RefusedError, match="there is no field 'x': the request takes none"):
        read_query(NoFields, {"x": "1"})


@pytest.mark.parametrize("text", ["", "fast", "nan", "inf", "1e999", "9" * 5000])
def test_numbers_of_a_query(text) -> None:
    with pytest.raises(RefusedError):
        read_query(Request, {"speed": text})


@pytest.mark.parametrize("text", ["inf", "-inf", "1e999"])
def test_numbers_without_limits_are_finite(text) -> None:
    class Speed(Fields):
        speed: float = 0.0

    with pytest.raises(RefusedError, match="speed must be"):
        read_query(Speed, {"speed": text})
