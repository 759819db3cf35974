"""Behaviours of PX4's modes: Takeoff, Return, Orbit, Descend, Termination.

The take-off command may come before or after arming; its altitude waits in the state until the mode is flown.
"""

from __future__ import annotations

from math import ceil, isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours import Circle, Orbit, ReturnToLaunch, Takeoff
from mavstack.sim.autopilot.behaviours.steps import ClimbControl, transition, wait

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.px4.state import OrbitRequest, Px4State

#: Bank and pitch of a gliding wing in radians; the bank makes the wing circle instead of flying away.
_BANK, _NOSE_DOWN = 0.26, -0.05


class Descend(Behaviour):
    """Descend level at landing speed, without a position."""

    landing = True

    def fly(self) -> Iterator[None]:
        """Descend until the vehicle is on the ground."""
        autopilot = self.autopilot
        if not autopilot.vehicle.vehicle_type.flies:
            yield from self._drift()
        if autopilot.maneuvers.circles and autopilot.vehicle.vehicle_type.flies:
            yield from self._glide()
        climb = ClimbControl(autopilot)
        while not autopilot.landed:
            thrust = climb.thrust(-autopilot.flight_parameters.land_speed)
            autopilot.body.hold_attitude(0.0, 0.0, None, thrust, yaw_rate=0.0)
            yield
        autopilot.body.idle()
        while True:
            yield

    def _drift(self) -> Iterator[None]:
        """Stop the motors of a vehicle that does not fly."""
        self.autopilot.body.idle()
        while True:
            yield

    def _glide(self) -> Iterator[None]:
        """Glide down on the wing; a VTOL changes to hover first."""
        yield from transition(self.autopilot, forward=False)
        while self.autopilot.maneuvers.circles and not self.autopilot.landed:
            self.autopilot.body.hold_attitude(_BANK, _NOSE_DOWN, None, 0.0, yaw_rate=0.0)
            yield


class Terminated(Behaviour):
    """Motors off after flight termination."""

    def fly(self) -> Iterator[None]:
        """Keep the motors stopped."""
        self.autopilot.body.stop()
        while True:
            yield


class Px4Takeoff(Takeoff):
    """Climb straight up, or like a wing; `forward` continues a VTOL's flight on its wing."""

    def __init__(self, autopilot: SimulatedAutopilot, state: Px4State, *, forward: bool = False) -> None:
        super().__init__(autopilot, forward=forward)
        self._state = state

    def fly(self) -> Iterator[None]:
        """Wait for the motors to spin up, then climb."""
        self._down = self._target_down()
        if self.autopilot.landed:
            self.autopilot.body.idle()
            yield from wait(self.autopilot, float(self.autopilot.vehicle.parameters["COM_SPOOLUP_TIME"]))
        yield from super().fly()

    def _target_down(self) -> float:
        """Return the target in local metres: the command's altitude or MIS_TAKEOFF_ALT; never below here."""
        autopilot, send_statustext = self.autopilot, self.autopilot.vehicle.send_statustext
        here = autopilot.maneuvers.place[2]
        altitude, self._state.takeoff_altitude = self._state.takeoff_altitude, None
        if altitude is None or not isfinite(altitude):
            height = autopilot.flight_parameters.takeoff_altitude
            send_statustext(f"Using default takeoff altitude: {height:.1f} m")
            return here - height
        down = autopilot.body.frame.altitude - altitude
        if down > here:
            send_statustext("Already higher than takeoff altitude", common.MavSeverity.CRITICAL)
        return min(down, here)


class Px4Return(ReturnToLaunch):
    """Return with PX4's status texts."""

    def _fly_back(self, home: Point) -> Iterator[None]:
        altitude = self.autopilot.body.frame.altitude
        top, ground = altitude - self._way_down(home), altitude - home[2]
        self.autopilot.vehicle.send_statustext(
            f"RTL: start return at {ceil(top)} m ({ceil(top - ground)} m above destination)"
        )
        yield from super()._fly_back(home)
        self.autopilot.vehicle.send_statustext("RTL: completed, loitering")

    def _land(self, home: Point | None) -> Iterator[None]:
        if home is not None:
            self.autopilot.vehicle.send_statustext("RTL: land at destination")
        yield from super()._land(home)


def orbit_behaviour(autopilot: SimulatedAutopilot, request: OrbitRequest | None) -> Behaviour:
    """Return the behaviour of Orbit; without a request, a circle around a point ahead."""
    if request is None:
        return Circle(autopilot)
    return Orbit(
        autopilot, request.centre, request.radius, speed=request.speed, yaw_behaviour=request.yaw_behaviour
    )
