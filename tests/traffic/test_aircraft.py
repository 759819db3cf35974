from __future__ import annotations

from math import nan

import pytest

from mavstack.geodesy import offset_location
from mavstack.traffic import Aircraft, AircraftTable, Report, closest_approach

HOME = (47.0, 8.0)


def at(north: float, east: float, **values) -> Aircraft:
    latitude, longitude = offset_location(*HOME, north, east)
    return Aircraft(1, 0.0, 0.0, latitude=latitude, longitude=longitude, **values)


def test_reports_are_joined_and_forgotten():
    table = AircraftTable()
    table.update(Report(7, callsign="ONE"), 0.0)
    table.update(Report(7, latitude=47.0, longitude=8.0, altitude=nan), 1.0)
    aircraft = table.update(Report(7, latitude=99.0, longitude=8.0, speed=3.0), 2.0)
    assert (aircraft.callsign, aircraft.latitude, aircraft.altitude, aircraft.speed) == (
        "ONE",
        47.0,
        None,
        3.0,
    )
    assert (aircraft.positioned, aircraft.seen) == (1.0, 2.0)
    assert [each.address for _, each in table.nearest(*HOME, 3.0, count=5, reach=10)] == [7]
    assert table.nearest(*HOME, 40.0, count=5, reach=10) == []
    table.forget_old(61.0)
    assert len(table) == 1
    table.forget_old(63.0)
    assert len(table) == 0


def test_the_nearest_come_first():
    table = AircraftTable()
    for number in range(1, 10):
        latitude, longitude = offset_location(*HOME, 100.0 * number, 0)
        table.update(Report(number, latitude=latitude, longitude=longitude), 0.0)
    found = table.nearest(*HOME, 0.0, count=3, reach=250)
    assert [(round(metres), each.address) for metres, each in found] == [(100, 1), (200, 2)]


def test_closest_approaches():
    crossing = closest_approach(
        at(0, 0, speed=10.0, course=0.0, altitude=100.0),
        at(600, 500, speed=10.0, course=270.0, altitude=160.0, climb=-1.0),
    )
    assert crossing.time == pytest.approx(55, abs=0.1)
    assert crossing.horizontal == pytest.approx(70.7, abs=0.5)
    assert crossing.vertical == pytest.approx(5, abs=0.1)
    leaving = closest_approach(at(0, 0), at(300, 0, speed=10.0, course=0.0))
    assert (leaving.time, round(leaving.horizontal), leaving.vertical) == (0.0, 300, 0.0)
    assert closest_approach(at(0, 0), Aircraft(2, 0.0)) is None
