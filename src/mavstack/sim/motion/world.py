"""All bodies of a simulation, and the step that moves them.

Columns are kept in the order of ORDER: each vehicle type is a slice, and so are the types that share a
control law. Wings are plane and vtol; vtol and copter have lifting motors; all types from vtol on can stop
and share the guidance; plane, vtol, copter and sub have attitude dynamics. A step is

    noise and wind -> guidance -> loops -> air, surfaces, motors -> rates, attitude -> position -> battery,
    sensors and estimate

where the loops use the estimate of the previous step. Only the laws of present types are run, and none from
guidance to position while all bodies are at rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.sim.motion import (
    aerodynamics,
    attitude,
    battery,
    estimate,
    ground,
    guidance,
    multirotor,
    rest,
    submarine,
    surface,
    vtol,
    wing,
)
from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.motion.arrays import Array, length
from mavstack.sim.motion.body import Body
from mavstack.sim.motion.initial_state import initial_column
from mavstack.sim.motion.noise import Noise
from mavstack.sim.motion.obstacles import Cylinder, Obstacle
from mavstack.sim.motion.sensors import Sensors, magnetic_field
from mavstack.sim.motion.state import StateArray
from mavstack.sim.motion.wind import WindModel
from mavstack.sim.vehicle_types import Home, VehicleType

if TYPE_CHECKING:
    from mavstack.sim.motion.external import ExternalMotion

ORDER = (
    VehicleType.PLANE,
    VehicleType.VTOL,
    VehicleType.COPTER,
    VehicleType.SUB,
    VehicleType.ROVER,
    VehicleType.BOAT,
)
#: Reports of the GPS receiver per second.
GPS_RATE = 5.0


class World:
    """Bodies, wind and time.

    Args:
        seed: Seed of all noise.
        rate: Steps per second, 10 to 1000.

    Raises:
        InvalidArgumentError: The rate is out of range.
    """

    def __init__(self, seed: int = 1, rate: float = 50.0) -> None:
        if not 10.0 <= rate <= 1000.0:
            raise InvalidArgumentError(f"the rate of a world must be 10 to 1000 Hz, got {rate}")
        self.rate = rate
        self.step_length = 1.0 / rate
        self.tick = 0
        self.bodies: list[Body] = []
        #: Bodies whose motion other programs compute.
        self.external: list[ExternalMotion] = []
        self._obstacles: list[tuple[Obstacle, LocalFrame]] = []
        self._noise = Noise(seed, self.step_length)
        self.sensors = Sensors(self._noise)
        self.wind = WindModel()
        self._origins = np.zeros((3, 0))
        self._gps_period = max(round(rate / GPS_RATE), 1)
        self._bind(np.zeros((StateArray.ROW_COUNT, 0)))

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return self.tick / self.rate

    # --- bodies

    def add(self, vehicle_type: VehicleType, home: Home) -> Body:
        """Add a body of a type at its home, on the ground or afloat."""
        vehicle_type = VehicleType(vehicle_type)
        body = Body(self, vehicle_type, home, len(self.bodies))
        place = ORDER.index(vehicle_type)
        body.column = sum(1 for other in self.bodies if ORDER.index(other.vehicle_type) <= place)
        for other in self.bodies:
            other.column += other.column >= body.column
        self.bodies.append(body)
        body.surroundings.cylinders += [_cylinder(body, *each) for each in self._obstacles]
        slow_noise = self._noise.insert(body.column, body.number)
        fresh = initial_column(
            AIRFRAMES[vehicle_type], home, slow_noise, self.step_length, body.number % self._gps_period
        )
        self._origins = np.insert(
            self._origins, body.column, (*magnetic_field(home.latitude), home.altitude), axis=1
        )
        self._bind(np.insert(self.state.data, body.column, fresh, axis=1))
        self.sensors.invalidate()
        attitude.update_axes(self._column(body.column))
        return body

    @property
    def obstacles(self) -> list[Obstacle]:
        """The obstacles, each in metres from the home that it was added with."""
        return [obstacle for obstacle, _ in self._obstacles]

    def add_obstacle(self, obstacle: Obstacle, home: Home) -> None:
        """Add an obstacle in metres from a home; it stands on the ground there."""
        frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        self._obstacles.append((obstacle.checked(), frame))
        for body in self.bodies:
            body.surroundings.cylinders.append(_cylinder(body, obstacle, frame))

    def _bind(self, data: Array) -> None:
        """Create the views of the slices of all types and laws."""
        self.state = StateArray(np.ascontiguousarray(data))
        #: True while all bodies are at rest, so that only a demand, wind or a new position can move them.
        self._at_rest = False
        counts = [
            sum(1 for body in self.bodies if body.vehicle_type is vehicle_type) for vehicle_type in ORDER
        ]
        ends = np.cumsum([0, *counts]).tolist()

        def part(first: int, last: int) -> StateArray:
            return self.state.select(slice(ends[first], ends[last + 1]))

        self._planes, self._vtols, self._copters, self._subs, self._rovers, self._boats = (
            part(row, row) for row in range(len(ORDER))
        )
        self._wings, self._lifters, self._hoverers = part(0, 1), part(1, 2), part(1, 5)
        self._tilting, self._surface = part(0, 3), part(4, 5)

    def _column(self, column: int) -> StateArray:
        return self.state.select(slice(column, column + 1))

    def place(self, column: int, place: tuple[float, float, float], yaw: float) -> None:
        """Move one body and its estimate to a position, at rest and level."""
        state, self._at_rest = self.state, False
        for name in ("velocity", "acceleration", "rates", "velocity_command", "integral", "thrust"):
            getattr(state, name)[:, column] = 0.0
        state.position[:, column] = place
        state.position[2, column] = np.clip(place[2], state.ceiling[column], state.floor[column])
        state.attitude[:, column] = (0.0, 0.0, yaw)
        state.position_estimate[:, column] = state.position[:, column] + state.position_error[:, column]
        state.velocity_estimate[:, column] = 0.0
        state.attitude_estimate[:, column] = (0.0, 0.0, yaw + state.yaw_error[column])
        down = state.position[2, column]
        state.on_ground[column] = down >= state.floor[column] or down <= state.ceiling[column]
        attitude.update_axes(self._column(column))

    def set_wind(self, speed: float, direction: float = 0.0, turbulence: float = 0.0) -> None:
        """Set the mean wind.

        Args:
            speed: m/s.
            direction: Where the wind comes from, in degrees.
            turbulence: Standard deviation of the gusts as a share of the speed.
        """
        self.wind.set(speed, direction, turbulence)

    def sensor_values(self, column: int) -> list[float]:
        """Return the values of a column's white-noise sensors."""
        return self.sensors.column(self.state, self._origins, self.tick, column)

    # --- one simulation step

    def step(self) -> None:
        """Advance every body by one step."""
        self.tick += 1
        if not self.bodies:
            return
        state, step = self.state, self.step_length
        self._noise.update_slow_noise(state.slow_noise, self.tick)
        self.wind.update(state)
        if not (self._at_rest and self.wind.is_calm) or rest.has_demand(state):
            self._move(step)
        for motion in self.external:
            motion.apply()
        battery.discharge(state, step)
        estimate.update_gps(state, self.tick, self._gps_period)
        estimate.update(state, step)

    def _move(self, step: float) -> None:
        """Compute the motion of one step."""
        state = self.state
        relative = state.velocity - state.air
        state.airspeed[:] = length(relative)
        state.force[:] = relative * -(state.drag_linear + state.drag_quadratic * state.airspeed)
        if self._hoverers.count:
            guidance.update_velocity_command(self._hoverers, step)
        self._fly(step)
        if self._subs.count:
            command, acceleration = submarine.control(self._subs, step)
            _store_command(self._subs, command)
            submarine.apply_forces(self._subs, acceleration)
        if self._surface.count:
            self._drive(step)
        if self._tilting.count:
            attitude.update_rates(self._tilting, step)
        attitude.integrate_rates(state, step)
        attitude.update_axes(state)
        ground.integrate(state, step)
        self._at_rest = self.wind.is_calm and rest.come_to_rest(state)
        self._record_outputs()

    def _fly(self, step: float) -> None:
        """Run bodies with wings or lifting motors."""
        planes, vtols, copters = self._planes.count, self._vtols.count, self._copters.count
        if vtols:
            vtol.update_transition(self._vtols, step)
        if planes or vtols:
            flown = wing.control(self._wings, step)
            aerodynamics.apply_wing(self._wings)
            push = flown.thrust
            if planes:
                _store_command(self._planes, multirotor.AttitudeCommand(*(row[:planes] for row in flown)))
        if vtols or copters:
            hover = multirotor.control(self._lifters, step)
            lift = hover.thrust
            if copters:
                _store_command(self._copters, multirotor.AttitudeCommand(*(row[vtols:] for row in hover)))
            if vtols:
                surfaces = self._vtols.authority.copy(), self._vtols.rate_disturbance.copy()
                mixed, pusher = vtol.blend(
                    self._vtols,
                    multirotor.AttitudeCommand(*(row[:vtols] for row in hover)),
                    multirotor.AttitudeCommand(*(row[planes:] for row in flown)),
                )
                _store_command(self._vtols, mixed)
                push[planes:] = pusher
                lift[:vtols] = mixed.thrust
            multirotor.apply_motor_failures(self._lifters)
            if vtols:
                vtol.share_authority(self._vtols, *surfaces)
            multirotor.apply_lift(self._lifters, lift)
        if planes or vtols:
            aerodynamics.apply_drive(self._wings, push)

    def _drive(self, step: float) -> None:
        """Run bodies on the surface."""
        turn, throttle = surface.control(self._surface, step)
        self._surface.yaw_rate_setpoint[:] = turn
        rovers = self._rovers.count
        for part, grip, rows in (
            (self._rovers, surface.WHEEL_DRAG, slice(0, rovers)),
            (self._boats, surface.HULL_DRAG, slice(rovers, None)),
        ):
            if part.count:
                surface.apply_forces(part, turn[rows], throttle[rows], grip, step)

    def _record_outputs(self) -> None:
        """Record the actuators' outputs for readers."""
        state = self.state
        np.divide(state.rates, state.rate_limit, out=state.controls)
        np.divide(state.lift_thrust, np.maximum(state.lift, 1.0), out=state.lift_share)
        np.minimum(np.maximum(state.lift_share, np.abs(state.drive_thrust)), 1.0, out=state.throttle)


def _cylinder(body: Body, obstacle: Obstacle, frame: LocalFrame) -> Cylinder:
    """Return an obstacle in the local frame of a body."""
    north, east, base = body.frame.to_local(*frame.to_global(obstacle.north, obstacle.east, 0.0))
    return Cylinder(north, east, obstacle.radius, base - obstacle.height)


def _store_command(part: StateArray, command: multirotor.AttitudeCommand) -> None:
    """Write an attitude command to its rows."""
    part.roll_setpoint[:] = command.roll
    part.pitch_setpoint[:] = command.pitch
    part.yaw_rate_setpoint[:] = command.turn
