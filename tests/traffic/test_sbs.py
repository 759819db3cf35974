from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.traffic import Report, SbsReader

POSITION = (
    b"MSG,3,1,1,4CA2D6,1,2026/11/28,12:00:00.000,2026/11/28,12:00:00.000,,37000,,,47.39,8.54,,,0,0,0,0\r\n"
)
VELOCITY = (
    b"MSG,4,1,1,4CA2D6,1,2026/11/28,12:00:00.000,2026/11/28,12:00:00.000,,,450,90.5,,,-640,,0,0,0,0\r\n"
)
NAME = b"MSG,1,1,1,4CA2D6,1,2026/11/28,12:00:00.000,2026/11/28,12:00:00.000,RYR1427,,,,,,,,,,,\r\n"
SQUAWK = b"MSG,6,1,1,4CA2D6,1,2026/11/28,12:00:00.000,2026/11/28,12:00:00.000,,,,,,,,7700,-1,-1,0,0\r\n"


@given(st.lists(st.integers(1, 50)))
def test_messages_in_any_cut(cuts):
    reader, data, reports = SbsReader(), POSITION + VELOCITY + NAME + SQUAWK, []
    for size in [*cuts, len(data)]:
        reports += reader.feed(data[:size])
        data = data[size:]
    place, speed, name, squawk = reports
    assert (place.address, place.latitude, place.longitude, place.altitude) == (
        0x4CA2D6,
        47.39,
        8.54,
        37000 * 0.3048,
    )
    assert speed.speed == pytest.approx(231.5)
    assert (speed.course, speed.climb) == (90.5, pytest.approx(-3.2512))
    assert (name.callsign, squawk.squawk) == ("RYR1427", 7700)


@given(st.lists(st.binary(max_size=100)))
def test_any_bytes_are_accepted(chunks):
    reader = SbsReader()
    for chunk in chunks:
        assert all(isinstance(report, Report) for report in reader.feed(chunk + b"\nMSG,3," + chunk))


def test_bad_lines_are_counted():
    reader = SbsReader()
    assert reader.feed(b"hello\nMSG,1,2\nMSG,3,1,1,ZZ" + b"," * 18 + b"\n") == []
    assert reader.bad == 3
