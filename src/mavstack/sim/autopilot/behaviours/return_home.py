"""Return to launch: climb, return, then descend or circle, by the flight parameters of the firmware.

    climb to the return altitude ── return ── wait above home ── land, or stay

A nearer rally point replaces home. A wing waits in circles, and stays there if the wait is infinite.
A surface vehicle returns and stops; a sub returns at its depth and surfaces.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.land import Land
from mavstack.sim.autopilot.behaviours.steps import change_altitude, fly_to, transition, wait
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point


class ReturnToLaunch(Behaviour):
    """Return home; `forward` makes a VTOL fly or hover, `lands` False omits the landing."""

    def __init__(
        self, autopilot: SimulatedAutopilot, *, forward: bool | None = None, lands: bool = True
    ) -> None:
        super().__init__(autopilot)
        self._forward = forward
        self._lands = lands

    def fly(self) -> Iterator[None]:
        """Run until the mode is left."""
        autopilot = self.autopilot
        if autopilot.landed and autopilot.vehicle.vehicle_type.flies:
            yield from self._land(None)
        home = autopilot.rally.destination()
        if autopilot.vehicle.vehicle_type.flies:
            yield from transition(autopilot, self._forward)
            yield from self._fly_back(home)
        else:
            yield from self._drive_back(home)
        while True:
            yield

    def _drive_back(self, home: Point) -> Iterator[None]:
        autopilot = self.autopilot
        here = autopilot.maneuvers.place[2]
        yield from fly_to(autopilot, (home[0], home[1], here))
        if autopilot.vehicle.vehicle_type is VehicleType.SUB and self._lands:
            yield from self._land(home)

    def _fly_back(self, home: Point) -> Iterator[None]:
        autopilot, maneuvers = self.autopilot, self.autopilot.maneuvers
        down = self._way_down(home)
        if not maneuvers.circles and down < maneuvers.place[2]:
            yield from change_altitude(autopilot, (*maneuvers.stopping_point[:2], down))
        over = home[0], home[1], down
        yield from self._go_over(over)
        waiting = home[0], home[1], max(down, home[2] - autopilot.flight_parameters.return_descend_altitude)
        yield from change_altitude(autopilot, waiting)
        stay = autopilot.flight_parameters.return_loiter_time
        if stay == inf or not self._lands:
            return
        yield from wait(autopilot, stay)
        yield from self._land(home)

    def _way_down(self, home: Point) -> float:
        """Return the altitude of the return in local metres; a wing that stays up may descend early."""
        flight_parameters, maneuvers = self.autopilot.flight_parameters, self.autopilot.maneuvers
        climb, here = flight_parameters.return_altitude, maneuvers.place[2]
        if not isfinite(climb):
            return here
        if flight_parameters.return_cone_slope > 0 and not maneuvers.circles:
            climb = min(climb, maneuvers.distance(home) * flight_parameters.return_cone_slope)
        wanted = home[2] - climb
        sinks = maneuvers.circles and flight_parameters.return_descend_altitude == inf
        return wanted if sinks else min(wanted, here)

    def _go_over(self, over: Point) -> Iterator[None]:
        maneuvers = self.autopilot.maneuvers
        if not maneuvers.circles:
            yield from fly_to(self.autopilot, over)
            return
        radius = self.autopilot.flight_parameters.loiter_radius
        maneuvers.circle(over, radius)
        while not maneuvers.has_entered_circle(over, radius):
            yield

    def _land(self, home: Point | None) -> Iterator[None]:
        self.landing = True
        yield from (self.autopilot.precise_landing(None) or Land(self.autopilot, home)).fly()
