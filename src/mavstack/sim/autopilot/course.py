"""The line that a mission flies, and its updates on the way.

A speed or heading chosen by another item takes effect immediately: the same line is demanded again. A region
of interest turns vehicles that can turn on the spot. A line to an item above the terrain follows it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, pi, remainder
from typing import TYPE_CHECKING

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.autopilot.payload import Payload

#: The yaw follows a region of interest in steps of this size, in radians.
_TURN = pi / 90
#: The altitude of a line that follows the terrain is rounded to multiples of this many metres.
_FOLLOWED = 0.25
_TURNS_ON_THE_SPOT = frozenset({VehicleType.COPTER, VehicleType.VTOL, VehicleType.SUB})


@dataclass(frozen=True, slots=True)
class _Choices:
    speed: float | None
    climb: float | None
    sink: float | None
    yaw: float | None
    down: float | None


class Course:
    """The current line of the mission."""

    def __init__(self, autopilot: SimulatedAutopilot, payload: Payload) -> None:
        self._autopilot = autopilot
        self._payload = payload
        self._point: Point | None = None
        self._start: Point | None = None
        self._yaw: float | None = None
        self._follow: Callable[[], float] | None = None
        self._demanded: _Choices | None = None

    @property
    def point(self) -> Point | None:
        """The target; None if no line is flown."""
        return self._point

    @property
    def followed_down(self) -> float | None:
        """The third local coordinate that the terrain demands now; None if no terrain is followed."""
        return self._demanded.down if self._demanded is not None else None

    def set(
        self,
        point: Point,
        *,
        start: Point | None = None,
        yaw: float | None = None,
        follow: Callable[[], float] | None = None,
    ) -> None:
        """Fly to a point.

        Args:
            point: The end of the line.
            start: Its start; None for the current position.
            yaw: The heading in radians; None for the chosen one.
            follow: Returns the third local coordinate to fly at, to follow the terrain; None for a line.
        """
        self._point, self._start, self._yaw = point, start or self._autopilot.maneuvers.place, yaw
        self._follow = follow
        self._demand()

    def clear(self) -> None:
        """Drop the line."""
        self._point = self._demanded = None

    def keep(self, *, again: bool = False) -> None:
        """Demand the line again if a chosen speed or yaw, or the height of the terrain, has changed."""
        if self._point is not None and (again or self._choices() != self._demanded):
            self._demand()

    def _demand(self) -> None:
        if self._point is None:
            return
        self._demanded = self._choices()
        point, start, down = self._point, self._start, self._demanded.down
        if down is not None:
            point, start = (*point[:2], down), start and (*start[:2], down)
        self._autopilot.maneuvers.go_to(point, start=start, yaw=self._demanded.yaw)

    def _choices(self) -> _Choices:
        maneuvers = self._autopilot.maneuvers
        yaw = maneuvers.yaw if self._yaw is None else self._yaw
        down = None if self._follow is None else round(self._follow() / _FOLLOWED) * _FOLLOWED
        return _Choices(maneuvers.speed, maneuvers.climb, maneuvers.sink, self._towards_region(yaw), down)

    def _towards_region(self, yaw: float | None) -> float | None:
        region = self._payload.region_of_interest
        if region is None or self._autopilot.vehicle.vehicle_type not in _TURNS_ON_THE_SPOT:
            return yaw
        north, east, _ = self._autopilot.maneuvers.place
        wanted = atan2(region[1] - east, region[0] - north)
        last = self._demanded.yaw if self._demanded is not None else None
        if last is not None and abs(remainder(wanted - last, 2 * pi)) < _TURN:
            return last
        return wanted
