from __future__ import annotations

import pytest

from mavstack.http.bodies import RefusedError
from mavstack.server.fields import MAX_TEXT, Field, read_fields, read_query

FIELDS = (
    Field(name="speed", about="Metres per second.", required=True, minimum=0, maximum=50),
    Field(name="count", type="integer", about="A number.", default=3),
    Field(name="force", type="boolean", about="Force it.", default=False),
    Field(name="kind", type="string", about="A kind.", choices=("a", "b")),
    Field(name="mode", type="value", about="A name or a number."),
    Field(name="file", type="string", about="A file.", max_length=8, pattern="[a-z]+"),
)


def test_values_and_defaults() -> None:
    found = read_fields(FIELDS, {"speed": 5, "kind": None, "mode": 4})
    assert found == {"speed": 5.0, "count": 3, "force": False, "kind": None, "mode": 4, "file": None}
    assert isinstance(found["speed"], float)


def test_a_query_has_texts() -> None:
    found = read_query(FIELDS, {"speed": "2.5", "count": "7", "force": "TRUE", "kind": "b"})
    assert found == {"speed": 2.5, "count": 7, "force": True, "kind": "b", "mode": None, "file": None}


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({}, "speed is missing: Metres per second."),
        ({"speed": None}, "speed is missing"),
        ({"speed": True}, "speed must be a number, got True"),
        ({"speed": "5"}, "speed must be a number, got '5'"),
        ({"speed": 51}, "speed must be at least 0 and at most 50, got 51"),
        ({"speed": 10**400}, "speed must be at least 0 and at most 50"),
        ({"speed": 1, "count": 1.5}, "count must be an integer, got 1.5"),
        ({"speed": 1, "kind": "c"}, "kind must be one of a, b, got 'c'"),
        ({"speed": 1, "mode": "x" * (MAX_TEXT + 1)}, "mode is longer than 4096 characters"),
        ({"speed": 1, "file": "abcdefghi"}, "file is longer than 8 characters"),
        ({"speed": 1, "file": "ab\n"}, "file must fit [a-z]+, got 'ab\\n'"),
        ({"speed": 1, "mode": []}, "mode must be a number or a string, got []"),
        ({"speed": 1, "sped": 2}, "there is no field 'sped': did you mean speed?"),
        ({"speed": 1, "x" * 5000: 2}, "…: there are speed, count, force, kind, mode, file"),
    ],
)
def test_wrong_values_are_refused_with_a_reason(values, problem) -> None:
    with pytest.raises(RefusedError) as caught:
        read_fields(FIELDS, values)
    assert problem in str(caught.value)
    assert caught.value.status == 400


def test_a_request_without_fields_takes_none() -> None:
    with pytest.raises(RefusedError, match="there is no field 'x': the request takes none"):
        read_query((), {"x": "1"})


@pytest.mark.parametrize("text", ["", "fast", "nan", "inf", "1e999", "9" * 5000])
def test_numbers_of_a_query(text) -> None:
    with pytest.raises(RefusedError):
        read_query(FIELDS, {"speed": text})


def test_the_schema_of_a_field() -> None:
    assert FIELDS[0].schema() == {
        "description": "Metres per second.",
        "type": "number",
        "minimum": 0,
        "maximum": 50,
    }
    assert FIELDS[3].schema()["enum"] == ["a", "b", None]
