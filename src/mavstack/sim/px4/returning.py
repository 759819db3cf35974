"""PX4's Return, with its words."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviours import ReturnToLaunch

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.maneuvers import Point


class Px4Return(ReturnToLaunch):
    """Says how high it comes back, and when it lands."""

    def _fly_back(self, home: Point) -> Iterator[None]:
        altitude = self.autopilot.body.frame.altitude
        top, ground = altitude - self._way_down(home), altitude - home[2]
        self._send_statustext(
            f"RTL: start return at {ceil(top)} m ({ceil(top - ground)} m above destination)"
        )
        yield from super()._fly_back(home)
        self._send_statustext("RTL: completed, loitering")

    def _land(self, home: Point | None) -> Iterator[None]:
        if home is not None:
            self._send_statustext("RTL: land at destination")
        yield from super()._land(home)

    def _send_statustext(self, text: str) -> None:
        self.autopilot.vehicle.send_statustext(text)
