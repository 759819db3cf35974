"""Samples for a vehicle: their age, numbers, frames and orientations."""

from __future__ import annotations

import math
from typing import Any

import pytest

from mavstack.bridges.core.inbound import MAX_AGE, Inbound, finite, location, quaternion, vector, yaw_of
from mavstack.bridges.core.view import Frames, VehicleView
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address

NOW = 1_700_000_000_000_000_000


def inbound() -> Inbound:
    frames = Frames("alpha/base_link", "alpha/map", "alpha/odom")
    return Inbound(Address(1, 1), VehicleView(lambda kind: None, frames=frames), now=NOW)


def sent_at(nanoseconds: int) -> dict[str, Any]:
    seconds, rest = divmod(nanoseconds, 1_000_000_000)
    return {"header": {"stamp": {"sec": seconds, "nanosec": rest}}}


def turned(length: float) -> dict[str, float]:
    return {"x": 0.0, "y": 0.0, "z": length * math.sin(0.2), "w": length * math.cos(0.2)}


def test_samples_of_half_a_second_ago_are_the_last_ones() -> None:
    for fields in (sent_at(NOW - MAX_AGE), sent_at(NOW + MAX_AGE), sent_at(0), {}):
        inbound().check_age(fields)
    with pytest.raises(InvalidArgumentError, match=r"0\.5 s old by its header"):
        inbound().check_age(sent_at(NOW - MAX_AGE - 1))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_are_finite(value: float) -> None:
    finite(0.0, -1e300)
    for read in (
        lambda: finite(0.0, value),
        lambda: vector({"x": 0.0, "y": value, "z": 0.0}),
        lambda: quaternion({"x": 0.0, "y": 0.0, "z": value, "w": 1.0}),
        lambda: location(value, 8.0),
    ):
        with pytest.raises(InvalidArgumentError, match="finite"):
            read()


@pytest.mark.parametrize("length", [0.92, 1.0, 1.08])
def test_quaternions_are_normed(length: float) -> None:
    found = quaternion(turned(length))
    assert math.hypot(*found) == pytest.approx(1.0)
    assert yaw_of(found) == pytest.approx(0.4)


@pytest.mark.parametrize("length", [0.0, 0.89, 1.11, 1e200])
def test_other_lengths_are_refused(length: float) -> None:
    with pytest.raises(InvalidArgumentError, match="must be a unit quaternion, got length"):
        quaternion(turned(length))


def test_frames_are_known() -> None:
    def is_body(name: str) -> bool:
        return inbound().is_body_frame({"header": {"frame_id": name}})

    assert [is_body(name) for name in ("alpha/base_link", "alpha/map", "alpha/odom", "earth")] == [
        True,
        False,
        False,
        False,
    ]
    for name in ("beta/base_link", "camera", "alpha/"):
        with pytest.raises(InvalidArgumentError, match="frame_id must be alpha/map or alpha/base_link, got"):
            is_body(name)
    with pytest.raises(InvalidArgumentError, match="frame_id must be alpha/map, got 'alpha/base_link'"):
        inbound().refuse_body_frame({"header": {"frame_id": "alpha/base_link"}})


def test_places_are_on_earth() -> None:
    assert location(-90.0, 180.0) == (-900_000_000, 1_800_000_000)
    for place in ((90.1, 0.0), (0.0, -180.1)):
        with pytest.raises(InvalidArgumentError, match="latitude must be within 90"):
            location(*place)
