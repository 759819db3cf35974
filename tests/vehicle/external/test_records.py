"""Records of measurements: columns, headers, objects, and the calls that they become."""

from __future__ import annotations

import asyncio
from math import inf, isnan
from unittest.mock import patch

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.external import records
from mavstack.vehicle.external.records import KINDS, RecordKind, RecordReader, arguments_of, send_record

POSE = {"position": [1.0, 2.0, 3.0], "orientation": [1.0, 0.0, 0.0, 0.0]}


@pytest.mark.parametrize(
    ("kind", "line", "expected"),
    [
        ("odometry", "5,1,2,3,1,0,0,0", {"time": 5.0, **POSE}),
        ("mocap", ",1,2,3,1,0,0,0", {"time": None, **POSE}),
        ("vision", "5,1,2,3,,,,,4,5,6", {"time": 5.0, "position": [1, 2, 3], "velocity": [4, 5, 6]}),
        ("gps", "5,47,8,488", {"time": 5.0, "latitude": 47.0, "longitude": 8.0, "altitude": 488.0}),
        ("landing-target", "5,1,2,3", {"time": 5.0, "forward": 1.0, "right": 2.0, "down": 3.0}),
        ("distance", "5,inf", {"time": 5.0, "distance": inf}),
        ("wind", "6.5,240", {"speed": 6.5, "direction": 240.0}),
        ("obstacles", "5,1,,inf", {"time": 5.0, "distances": [1.0, None, inf]}),
        ("odometry", '{"position": [1, 2, 3], "frame": "NED"}', {"position": [1, 2, 3], "frame": "NED"}),
    ],
)
def test_lines(kind, line, expected):
    assert RecordReader(kind).read(line) == (kind, expected)


def test_a_header_names_the_columns_of_the_lines_behind_it():
    reader = RecordReader("odometry")
    assert reader.read("vx, vy, vz, quality") is None
    assert reader.read("# a comment") is None
    assert reader.read(" ") is None
    assert reader.read("1,2,3,90") == ("odometry", {"velocity": [1.0, 2.0, 3.0], "quality": 90.0})


def test_a_line_has_a_bounded_number_of_columns():
    assert RecordReader("obstacles").read("," + "1," * 198 + "1") is not None
    with pytest.raises(InvalidArgumentError, match="the line has 201 numbers for 200 columns"):
        RecordReader("obstacles").read("," + "1," * 199 + "1")


def test_an_object_may_name_another_kind():
    assert RecordReader("odometry").read('{"record": "distance", "distance": 2}') == (
        "distance",
        {"distance": 2},
    )


@pytest.mark.parametrize(
    ("kind", "values", "problem"),
    [
        ("radar", {}, "'radar' is not a kind of record; kinds: odometry, "),
        ("gps", {"latitude": 1.0}, "gps: longitude is missing; arguments: latitude, longitude, "),
        ("gps", {"lat": 1.0}, "gps: lat is not an argument"),
        ("odometry", {"position": [1.0]}, "position needs 3 finite numbers"),
        ("odometry", {"position": "abc"}, "odometry: must be real number"),
    ],
)
def test_records_that_are_not_possible(kind, values, problem):
    with pytest.raises(InvalidArgumentError, match=problem):
        asyncio.run(send_record(None, kind, values))


def test_defaults_apply_where_the_call_has_them():
    sent = []

    def call(external, distance, *, frame="ENU"):
        sent.append((external, distance, frame))

    with patch.object(records, "KINDS", {"distance": RecordKind(call, "time")}):
        defaults = {"frame": "NED", "body_frame": "FRD"}
        asyncio.run(send_record("vehicle", "distance", {"distance": [1, None]}, defaults))
    assert sent[0][0::2] == ("vehicle", "NED")
    assert sent[0][1][0] == 1
    assert isnan(sent[0][1][1])


LINES = st.one_of(st.text(), st.from_regex(r"[{\[\]},:\"0-9a-z. -]+"))


@given(kind=st.sampled_from(sorted(KINDS)), text=LINES)
def test_any_text_is_a_record_or_refused(kind, text):
    reader = RecordReader(kind)
    for line in text.splitlines():
        try:
            record = reader.read(line)
        except InvalidArgumentError:
            continue
        assert record is None or isinstance(record[1], dict)


def test_every_measurement_has_its_time():
    assert all("time" in arguments_of(kind) for kind in KINDS if kind != "wind")
