"""All bodies of a simulation, and the step that moves them.

Columns are kept in the order of ORDER: each type is a slice, and so are those that share a law. Wings are
plane and vtol; vtol and copter have lifting motors; from vtol on all can stop and share the guidance; what
leans is everything but rover and boat. A step is

    noise and wind -> guidance -> loops -> air, surfaces, motors -> rates, attitude -> place -> battery,
    sensors and estimate

with loops that see the estimate of the step before. Only the laws of types present are run.
"""

from __future__ import annotations

import numpy as np

from mavstack.sim.kinds import Home, VehicleType
from mavstack.sim.motion import (
    aerodynamics,
    attitude,
    battery,
    estimate,
    ground,
    guidance,
    multirotor,
    submarine,
    surface,
    vtol,
    wing,
)
from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.motion.arrays import Array, length
from mavstack.sim.motion.body import Body
from mavstack.sim.motion.fleet import Fleet
from mavstack.sim.motion.noise import Noise
from mavstack.sim.motion.sensors import Sensors, field
from mavstack.sim.motion.spawn import new_column
from mavstack.sim.motion.wind import Weather

ORDER = (
    VehicleType.PLANE,
    VehicleType.VTOL,
    VehicleType.COPTER,
    VehicleType.SUB,
    VehicleType.ROVER,
    VehicleType.BOAT,
)
#: GPS receivers report so many times a second.
GPS_RATE = 5.0


class World:
    """Bodies, wind and time."""

    def __init__(self, seed: int = 1, rate: float = 50.0) -> None:
        if not 10.0 <= rate <= 1000.0:
            raise ValueError(f"a world steps 10 to 1000 times a second, not {rate}")
        self.rate = rate
        self.step_length = 1.0 / rate
        self.tick = 0
        self.bodies: list[Body] = []
        self._noise = Noise(seed, self.step_length)
        self.sensors = Sensors(self._noise)
        self.weather = Weather()
        self._fields = np.zeros((3, 0))
        self._gps_period = max(round(rate / GPS_RATE), 1)
        self._bind(np.zeros((Fleet.HEIGHT, 0)))

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return self.tick / self.rate

    # --- bodies

    def add(self, kind: VehicleType, home: Home) -> Body:
        """Put a body of a type at its home, on the ground or afloat."""
        kind = VehicleType(kind)
        body = Body(self, kind, home, len(self.bodies))
        place = ORDER.index(kind)
        body.column = sum(1 for other in self.bodies if ORDER.index(other.type) <= place)
        for other in self.bodies:
            other.column += other.column >= body.column
        self.bodies.append(body)
        wander = self._noise.insert(body.column, body.number)
        fresh = new_column(AIRFRAMES[kind], home, wander, self.step_length, body.number % self._gps_period)
        self._fields = np.insert(self._fields, body.column, (*field(home.latitude), home.altitude), axis=1)
        self._bind(np.insert(self.fleet.data, body.column, fresh, axis=1))
        self.sensors.forget()
        attitude.orient(self._column(body.column))
        return body

    def _bind(self, data: Array) -> None:
        """Make the views of the slices of all types and laws."""
        self.fleet = Fleet(np.ascontiguousarray(data))
        counts = [sum(1 for body in self.bodies if body.type is kind) for kind in ORDER]
        ends = np.cumsum([0, *counts]).tolist()

        def part(first: int, last: int) -> Fleet:
            return self.fleet.part(slice(ends[first], ends[last + 1]))

        self._planes, self._vtols, self._copters, self._subs, self._rovers, self._boats = (
            part(row, row) for row in range(len(ORDER))
        )
        self._wings, self._lifters, self._movers = part(0, 1), part(1, 2), part(1, 5)
        self._leaners, self._surface = part(0, 3), part(4, 5)

    def _column(self, column: int) -> Fleet:
        return self.fleet.part(slice(column, column + 1))

    def put(self, column: int, place: tuple[float, float, float], yaw: float) -> None:
        """Put one body somewhere, at rest and level, its estimate with it."""
        fleet = self.fleet
        for name in ("velocity", "acceleration", "rates", "velocity_command", "integral", "thrust"):
            getattr(fleet, name)[:, column] = 0.0
        fleet.position[:, column] = place
        fleet.position[2, column] = np.clip(place[2], fleet.ceiling[column], fleet.floor[column])
        fleet.attitude[:, column] = (0.0, 0.0, yaw)
        fleet.position_estimate[:, column] = fleet.position[:, column] + fleet.position_error[:, column]
        fleet.velocity_estimate[:, column] = 0.0
        fleet.attitude_estimate[:, column] = (0.0, 0.0, yaw + fleet.yaw_error[column])
        down = fleet.position[2, column]
        fleet.on_ground[column] = down >= fleet.floor[column] or down <= fleet.ceiling[column]
        attitude.orient(self._column(column))

    def set_wind(self, speed: float, direction: float = 0.0, turbulence: float = 0.0) -> None:
        """Let the wind blow at `speed` m/s from `direction` in degrees, with gusts a share of it."""
        self.weather.set(speed, direction, turbulence)

    def measured(self, column: int) -> list[float]:
        """Give what the white-noise sensors of a column read."""
        return self.sensors.column(self.fleet, self._fields, self.tick, column)

    # --- a step

    def step(self) -> None:
        """Move every body on by a step."""
        self.tick += 1
        if not self.bodies:
            return
        fleet, step = self.fleet, self.step_length
        self._noise.wander(fleet.wander, self.tick)
        self.weather.blow(fleet)
        relative = fleet.velocity - fleet.air
        fleet.airspeed[:] = length(relative)
        fleet.force[:] = relative * -(fleet.drag_linear + fleet.drag_quadratic * fleet.airspeed)
        if self._movers.count:
            guidance.guide(self._movers, step)
        self._fly(step)
        if self._subs.count:
            wish, wanted = submarine.control(self._subs, step)
            _want(self._subs, wish)
            submarine.move(self._subs, wanted)
        if self._surface.count:
            self._drive(step)
        if self._leaners.count:
            attitude.pull(self._leaners, step)
        attitude.turn(fleet, step)
        attitude.orient(fleet)
        ground.move(fleet, step)
        self._note()
        battery.drain(fleet, step)
        estimate.receive(fleet, self.tick, self._gps_period)
        estimate.update(fleet, step)

    def _fly(self, step: float) -> None:
        """Run what has wings or lifting motors."""
        planes, vtols, copters = self._planes.count, self._vtols.count, self._copters.count
        if vtols:
            vtol.shift(self._vtols, step)
        if planes or vtols:
            flown = wing.control(self._wings, step)
            aerodynamics.feel(self._wings)
            push = flown.thrust
            if planes:
                _want(self._planes, multirotor.Wish(*(row[:planes] for row in flown)))
        if vtols or copters:
            hover = multirotor.control(self._lifters, step)
            lift = hover.thrust
            if copters:
                _want(self._copters, multirotor.Wish(*(row[vtols:] for row in hover)))
            if vtols:
                surfaces = self._vtols.authority.copy(), self._vtols.push.copy()
                mixed, pusher = vtol.blend(
                    self._vtols,
                    multirotor.Wish(*(row[:vtols] for row in hover)),
                    multirotor.Wish(*(row[planes:] for row in flown)),
                )
                _want(self._vtols, mixed)
                push[planes:] = pusher
                lift[:vtols] = mixed.thrust
            multirotor.wear(self._lifters)
            if vtols:
                vtol.share_authority(self._vtols, *surfaces)
            multirotor.lift(self._lifters, lift)
        if planes or vtols:
            aerodynamics.drive(self._wings, push)

    def _drive(self, step: float) -> None:
        """Run what stays on the surface."""
        turn, throttle = surface.control(self._surface, step)
        rovers = self._rovers.count
        for part, grip, rows in (
            (self._rovers, surface.GRIP, slice(0, rovers)),
            (self._boats, surface.HULL, slice(rovers, None)),
        ):
            if part.count:
                surface.move(part, turn[rows], throttle[rows], grip, step)

    def _note(self) -> None:
        """Keep what the actuators did, for readers."""
        fleet = self.fleet
        np.divide(fleet.rates, fleet.rate_limit, out=fleet.controls)
        np.divide(fleet.lift_thrust, np.maximum(fleet.lift, 1.0), out=fleet.lift_share)
        np.minimum(np.maximum(fleet.lift_share, np.abs(fleet.drive_thrust)), 1.0, out=fleet.throttle)


def _want(part: Fleet, wish: multirotor.Wish) -> None:
    part.roll_wanted[:] = wish.roll
    part.pitch_wanted[:] = wish.pitch
    part.turn_wanted[:] = wish.turn
