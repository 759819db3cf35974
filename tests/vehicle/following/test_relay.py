"""The messages about a leader that its followers receive."""

from __future__ import annotations

from math import atan2, cos, degrees, radians, remainder, sin

import pytest

from mavstack.dialects import common
from mavstack.geodesy import LocalFrame
from mavstack.swarm.leader import COURSE_TIME
from mavstack.vehicle.following.relay import LeaderMotion

FRAME = LocalFrame(47.4, 8.5, 0.0)
INTERVAL = 0.2
#: Seconds by which the course lags after each position.
LAG = COURSE_TIME - INTERVAL


def position(time, north, east, course, speed=2.0):
    latitude, longitude, altitude = FRAME.to_global(north, east, -430.0)
    return common.GlobalPositionInt(
        time_boot_ms=round(1000.0 * time),
        lat=round(latitude * 1e7),
        lon=round(longitude * 1e7),
        alt=round(altitude * 1e3),
        relative_alt=20_000,
        vx=round(100.0 * speed * cos(radians(course))),
        vy=round(100.0 * speed * sin(radians(course))),
        vz=-100,
        hdg=27_000,
    )


def drive(gain, rate, seconds=15.0, *, late=0.0):
    """Return the last messages about a leader that turns, its last position and its course in degrees."""
    motion, found, course, north, east = LeaderMotion(FRAME, gain), (), 30.0, 0.0, 0.0
    for step in range(round(seconds / INTERVAL)):
        now = step * INTERVAL
        last = position(now, north, east, course)
        motion.update(last, now)
        found = tuple(motion.messages(now + late))
        assert not list(motion.messages(now + late)), "each position is sent once"
        north += 2.0 * INTERVAL * cos(radians(course))
        east += 2.0 * INTERVAL * sin(radians(course))
        course += rate * INTERVAL
    return *found, last, course - rate * INTERVAL


def heading_of(target):
    w, _, _, z = target.attitude_q
    return degrees(2.0 * atan2(z, w)) % 360.0


@pytest.mark.parametrize("gain", [None, 1.0])
def test_a_heading_is_the_course_of_a_leader_that_does_not_turn(gain):
    target, place, _, course = drive(gain, 0.0)
    assert place.hdg / 100.0 == pytest.approx(course, abs=0.2)
    assert heading_of(target) == pytest.approx(course, abs=0.2)


@pytest.mark.parametrize("rate", [-5.0, 5.0])
@pytest.mark.parametrize("gain", [0.5, 1.0])
def test_a_heading_is_ahead_in_a_turn_by_the_time_in_which_followers_correct_an_error(rate, gain):
    target, place, _, course = drive(gain, rate)
    wanted = (course + rate * (1.0 / gain + INTERVAL)) % 360.0
    assert place.hdg / 100.0 == pytest.approx(wanted, abs=0.3)
    assert heading_of(target) == pytest.approx(wanted, abs=0.3)


def test_followers_with_small_gains_receive_the_course():
    _, place, _, course = drive(None, 5.0)
    assert place.hdg / 100.0 == pytest.approx(course - 5.0 * LAG, abs=0.3)


def test_a_heading_is_ahead_by_half_of_a_right_angle_and_no_more():
    _, place, _, course = drive(0.1, 20.0, 8.0)
    assert (place.hdg / 100.0 - course) % 360.0 == pytest.approx(45.0 - 20.0 * LAG, abs=1.0)


def test_places_are_those_of_the_time_of_sending():
    target, place, last, _ = drive(None, 0.0, late=0.15)
    assert place.time_boot_ms == target.timestamp == last.time_boot_ms + 150
    before = FRAME.to_local(last.lat / 1e7, last.lon / 1e7, last.alt / 1e3)
    for latitude, longitude, altitude in (
        (place.lat, place.lon, place.alt / 1e3),
        (target.lat, target.lon, target.alt),
    ):
        after = FRAME.to_local(latitude / 1e7, longitude / 1e7, altitude)
        moved = [new - old for new, old in zip(after, before, strict=True)]
        assert moved == pytest.approx([last.vx * 0.0015, last.vy * 0.0015, last.vz * 0.0015], abs=0.02)
    assert place.relative_alt == 20_000 + place.alt - last.alt == pytest.approx(20_150, abs=20)
    assert tuple(target.vel) == pytest.approx((last.vx / 100.0, last.vy / 100.0, last.vz / 100.0))


def steering_errors(noise, rate=0.0, offset=0.0):
    """Return the errors of the course of a leader that steers, whose velocity is wrong by some degrees."""
    motion, found, course = LeaderMotion(FRAME, steers=True), [], 30.0
    for step in range(150):
        now = step * INTERVAL
        wrong = course + noise * sin(2.0 * now)
        heading = round(100.0 * (course + offset)) % 36_000
        motion.update(position(now, 0.0, 0.0, wrong).replace(hdg=heading), now)
        assert list(motion.messages(now))
        found.append(remainder(motion.course - course, 360.0))
        course += rate * INTERVAL
    return found


@pytest.mark.parametrize("rate", [0.0, 8.0, -8.0])
def test_the_course_of_a_leader_that_steers_turns_with_its_heading(rate):
    assert max(map(abs, steering_errors(4.0, rate))) < 0.5


def test_a_heading_that_is_wrong_is_corrected_by_the_velocity():
    errors = steering_errors(0.0, offset=20.0)
    assert errors[0] == pytest.approx(20.0, abs=1.0)
    assert abs(errors[-1]) < 1.0
