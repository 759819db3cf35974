"""The takeoff of a group of which some members fly."""

from __future__ import annotations

import pytest

from mavstack.vehicle.swarm.launch import take_off


class Vehicle:
    """A vehicle that notes its calls."""

    def __init__(self, *, in_air, armed):
        self.in_air, self.armed, self.calls = in_air, armed, []

    async def arm(self, *, timeout):
        self.calls.append("arm")

    async def takeoff(self, altitude, *, timeout):
        self.calls.append(f"takeoff {altitude}")


class Group(list):
    """A group whose calls succeed."""

    async def each(self, call, *, name):
        for vehicle in self:
            await call(vehicle)


@pytest.mark.parametrize(
    ("in_air", "armed", "calls"),
    [
        (False, False, ["arm", "takeoff 10.0"]),
        (False, True, ["takeoff 10.0"]),
        (True, True, []),
        (True, False, ["arm", "takeoff 10.0"]),
        (None, None, ["arm", "takeoff 10.0"]),
    ],
)
async def test_who_takes_off(in_air, armed, calls):
    vehicle = Vehicle(in_air=in_air, armed=armed)
    await take_off(Group([vehicle]), 10.0)
    assert vehicle.calls == calls
