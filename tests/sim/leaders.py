"""A leader that moves as a test says, as its messages tell it."""

from __future__ import annotations

from math import atan2, degrees
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import Address

if TYPE_CHECKING:
    from tests.sim.harness import VehicleHarness

LEADER = Address(7, 1)


class MovingLeader:
    """A leader with a constant velocity, in local metres of a vehicle; `report` sends its message.

    Args:
        harness: The follower.
        place: North, east, down in metres at the begin.
        velocity: North, east, down in m/s.
        message: GlobalPositionInt or FollowTarget.
    """

    def __init__(
        self,
        harness: VehicleHarness,
        place: tuple[float, float, float],
        velocity: tuple[float, float, float],
        message: type[common.GlobalPositionInt | common.FollowTarget] = common.GlobalPositionInt,
    ) -> None:
        self._harness, self._begin, self._message = harness, place, message
        self._started = harness.vehicle.now
        self.velocity = velocity

    @property
    def place(self) -> tuple[float, float, float]:
        passed = self._harness.vehicle.now - self._started
        north, east, down = (
            at + speed * passed for at, speed in zip(self._begin, self.velocity, strict=True)
        )
        return north, east, down

    def report(self) -> None:
        vehicle = self._harness.vehicle
        latitude, longitude, altitude = vehicle.body.frame.to_global(*self.place)
        north, east, down = self.velocity
        lat, lon = round(latitude * 1e7), round(longitude * 1e7)
        if self._message is common.FollowTarget:
            target = common.FollowTarget(
                est_capabilities=3, lat=lat, lon=lon, alt=altitude, vel=self.velocity
            )
            self._harness.send(target, LEADER)
            return
        home = vehicle.autopilot.home.altitude
        self._harness.send(
            common.GlobalPositionInt(
                time_boot_ms=vehicle.uptime_ms,
                lat=lat,
                lon=lon,
                alt=round(altitude * 1e3),
                relative_alt=round((altitude - home) * 1e3),
                vx=round(north * 100),
                vy=round(east * 100),
                vz=round(down * 100),
                hdg=round(degrees(atan2(east, north)) % 360 * 100) % 36000,
            ),
            LEADER,
        )
