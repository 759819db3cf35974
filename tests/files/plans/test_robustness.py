"""Whatever a file holds, parsing it ends in a plan or in a PlanFileError; so does writing what was read."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import PlanFileError
from mavstack.files.plans import FORMATS, check, format_plan, parse_plan, read_plan
from tests.files.plans.plans import FENCE, FLIGHT, RALLY, WAYPOINTS

if TYPE_CHECKING:
    from collections.abc import Callable

SAMPLES = [FLIGHT, WAYPOINTS, FENCE, RALLY, format_plan(parse_plan(FLIGHT), "json").text]
JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=5),
    st.just([]),
    st.just({}),
    st.just(10**400),
)


def check_parsing(content: str | bytes) -> None:
    """Read, check and write it, as a program would; errors are of one kind, one line, and name the file."""
    plan, problem = attempt(lambda: parse_plan(content, "file"))
    if plan is None:
        assert problem.startswith("file: ")
        return
    check(plan)
    for name in FORMATS:
        written, _ = attempt(lambda name=name: format_plan(plan, name))
        assert written is not None or name in ("fence", "rally")
        if written is not None:
            attempt(lambda written=written: parse_plan(written.text))


def attempt(work: Callable[[], Any]) -> tuple[Any, str]:
    try:
        return work(), ""
    except PlanFileError as error:
        problem = str(error)
    assert "\n" not in problem
    return None, problem


@given(st.binary(max_size=200))
def test_any_bytes(data):
    check_parsing(data)


@given(st.text(max_size=200))
def test_any_text(text):
    check_parsing(text)


@given(st.sampled_from(SAMPLES), st.data())
def test_truncated_files(text, data):
    check_parsing(text[: data.draw(st.integers(0, len(text)))])


@given(st.sampled_from(SAMPLES), st.data())
def test_damaged_files(text, data):
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, min(len(text), start + 30)))
    check_parsing(
        text[:start] + data.draw(st.text('0123456789.-+eE\t {}[],:"nulaif#\n', max_size=6)) + text[end:]
    )


@given(st.sampled_from([FLIGHT, SAMPLES[-1]]), st.data())
def test_json_with_random_values(text, data):
    root = json.loads(text)
    where = root
    while True:
        keys = list(where) if isinstance(where, dict) else list(range(len(where)))
        key = data.draw(st.sampled_from(keys))
        if isinstance(where[key], dict | list) and where[key] and data.draw(st.booleans()):
            where = where[key]
            continue
        if isinstance(where, dict) and data.draw(st.booleans()):
            del where[key]
        else:
            where[key] = data.draw(JUNK)
        break
    check_parsing(json.dumps(root))


@given(st.sampled_from([WAYPOINTS, FENCE, RALLY]), st.data())
def test_lists_with_random_values(text, data):
    lines = text.splitlines()
    number = data.draw(st.integers(0, len(lines) - 1))
    words = lines[number].split()
    at = data.draw(st.integers(0, len(words) - 1))
    words[at] = data.draw(st.one_of(st.text(max_size=5), st.integers().map(str), st.floats().map(str)))
    check_parsing("\n".join([*lines[:number], "\t".join(words), *lines[number + 1 :]]))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "it is empty"),
        ("hello\nworld\n", "it is neither"),
        ("QGC WPL PB 110\n", "line 1: version 'PB 110' is not supported"),
        ("QGC WPL 130\n", "line 1: version '130' is not supported"),
        ("QGC WPL 110\n\n0 1 2\n", "line 3: has 3 columns instead of 12"),
        (WAYPOINTS.replace("520.25", "high"), "line 5: the altitude is 'high', which is not a number"),
        (WAYPOINTS.replace("\t177\t", "\t99999\t"), "line 6: the command is '99999'"),
        (WAYPOINTS.replace("\t177\t", "\t1_7\t"), "line 6: the command is '1_7', which is not a whole"),
        (WAYPOINTS.replace("488", "\u0664\u0664"), "line 2: the altitude is"),
        ("47.1 8.1\n47.2\n", "line 2: has 1 values instead of a latitude and a longitude"),
        ("47.1 8.1\n47.2 8.2\n47.3 8.3\n", "a fence needs a return point and at least 3 vertices"),
        ("RALLY 1 2 3 4\n", "line 1: it is 'RALLY' and 4 values instead of RALLY and six"),
        ("RALLY 1 2 3 0 0 20\n", "flags 20 mean an altitude above the origin"),
        ("{", "line 1: it is not JSON"),
        ("{}", "it has none of mission, geoFence and rallyPoints"),
        ('{"a":' * 100_000, "nested too deeply"),
        ('{"mission": {"items": [' + "1" * 5000 + "]}}", "a number that is too long"),
        ('{"mission": {"items": 5}}', "mission.items: is 5 where an array must be"),
        ('{"mission": {"version": 3, "items": []}}', "mission.version: version 3 is not supported"),
        ('{"version": 2, "mission": {"items": []}}', "version: version 2 is not supported, only 1"),
        (FLIGHT.replace('"command": 177', '"command": "jump"'), "mission.items[3].command: is 'jump'"),
        (FLIGHT.replace("[2, 3, 0, 0, 0, 0, 0]", "[2, 3]"), "mission.items[3].params: has 2 params"),
        (
            FLIGHT.replace('"SimpleItem", "command": 177', '"Odd"'),
            "mission.items[3]: has the unknown item type",
        ),
        (FLIGHT.replace("[47.40, 8.54]", '["N", 8.54]'), "geoFence.polygons[0].polygon[0][0]: is 'N'"),
        (FLIGHT.replace('"radius": 25.5', '"radius": null'), "circles[0].circle.radius: is None where"),
        (FLIGHT.replace("[47.396, 8.544, 25]", "[47.396]"), "rallyPoints.points[0]: has 1 values"),
    ],
)
def test_an_error_names_the_problem_and_the_place(text, problem):
    with pytest.raises(PlanFileError) as caught:
        parse_plan(text, "my.plan")
    assert str(caught.value).startswith("my.plan: ")
    assert problem in str(caught.value)


def test_an_error_can_be_pickled_and_holds_its_parts():
    import pickle

    with pytest.raises(PlanFileError) as caught:
        parse_plan("QGC WPL 110\n0\n", "my.txt")
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.path, error.where, str(error)) == ("my.txt", "line 2", str(caught.value))


def test_control_characters_are_escaped_in_errors():
    with pytest.raises(PlanFileError) as caught:
        parse_plan(WAYPOINTS.replace("488", "\x1b[2J"), "my.txt")
    assert "\x1b" not in str(caught.value)


@pytest.mark.nightly
def test_sizes_are_bounded(tmp_path, monkeypatch):
    from mavstack.files.plans import parsing, registry

    many = "QGC WPL 110\n" + "0\t0\t0\t16\t0\t0\t0\t0\t1\t2\t3\t1\n" * 65536
    assert len(parse_plan(many).mission) == 65535
    with pytest.raises(PlanFileError, match="65537 items are more than the 65535"):
        parse_plan(many + many.splitlines()[1])
    monkeypatch.setattr(parsing, "MAX_BYTES", 100)
    monkeypatch.setattr(registry, "MAX_BYTES", 100)
    path = tmp_path / "big.plan"
    path.write_text(FLIGHT)
    with pytest.raises(PlanFileError, match=r"big\.plan: 101 bytes are too many for a plan file"):
        read_plan(path)


def test_an_endless_number_is_refused():
    with pytest.raises(PlanFileError, match=r"the altitude is '1111.*…, which is not a number"):
        parse_plan(WAYPOINTS.replace("488", "1" * 100_000 + "x"))


def test_a_directory_and_a_path_with_a_nul(tmp_path):
    for path in (tmp_path, "a\0b"):
        with pytest.raises(PlanFileError):
            read_plan(path)
