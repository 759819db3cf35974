"""A handle on one simulated body: readings (`BodyReader`), demands, limits and faults.

A demand is written to the body's column once and holds until the next demand; every step of the world flies
it. A demand without yaw keeps the last heading, unless it is a line long enough to define one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavstack.sim.motion import aiding, faults
from mavstack.sim.motion.airframes import AIRFRAMES, limit_range
from mavstack.sim.motion.body_reader import BodyReader
from mavstack.sim.motion.demands import (
    MAX_DISTANCE,
    MIN_HEADING_LINE,
    Demand,
    Mode,
    YawMode,
    angle,
    finite,
    line,
)
from mavstack.sim.motion.readings import FIX_3D, GpsReport, Limits
from mavstack.sim.motion.sensors import PRECISION
from mavstack.sim.motion.state import StateArray
from mavstack.sim.vehicle_types import Home, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.motion.world import World


_ROWS = {name: slice(first, first + count) for name, (first, count) in StateArray.ROWS.items()}
_LIMITS = slice(_ROWS["speed"].start, _ROWS["speed"].start + len(Limits._fields))
_DEMAND = slice(_ROWS["mode"].start, _ROWS["forward_requested"].start)
_REVERSES = (VehicleType.ROVER, VehicleType.BOAT, VehicleType.SUB)
_SPEED_LIMITS = ("speed", "climb", "sink", "airspeed_cruise")


class Body(BodyReader):
    """One simulated body of a world."""

    def __init__(self, world: World, vehicle_type: VehicleType, home: Home, number: int) -> None:
        super().__init__(world, vehicle_type, home, number)
        self._heading: float | None = None
        self._has_requested_speed = (False, False, False, False)
        self._failed_motors: set[int] = set()
        #: A function that changes each demanded velocity (m/s north, east, down) before it is used; None: no
        #: function.
        self.velocity_filter: Callable[[float, float, float], tuple[float, float, float]] | None = None
        #: Faults of the body's own GPS receiver: whether it failed, and the offset of spoofing in metres
        #: north and east.
        self._gps_failed, self._gps_offset = False, (0.0, 0.0)

    # --- limits

    def set_limit(self, name: str, value: float) -> None:
        """Set one of the fields of `Limits`.

        Args:
            name: The field's name.
            value: The new value in the unit of the field; clipped to the range that the airframe allows.
        """
        low, high = limit_range(self.vehicle_type, name)
        before = self.limits
        values = before._replace(**{name: finite(value, getattr(before, name), low, high)})
        if name == "speed" and self.vehicle_type is VehicleType.PLANE:
            values = values._replace(airspeed_cruise=values.speed)
        state = self._world.state
        state.data[_LIMITS, self.column] = values
        for row, is_requested in enumerate(self._has_requested_speed):
            if not is_requested:
                state.speeds[row, self.column] = getattr(values, _SPEED_LIMITS[row])
        self._invalidate()

    def _bounded_speeds(
        self, speed: float | None, climb: float | None = None, sink: float | None = None
    ) -> tuple[float, float, float, float]:
        """Clip the requested speeds to the airframe's maxima; the limits replace those that are None."""
        limits, airframe = self.limits, AIRFRAMES[self.vehicle_type]
        requested = (speed, climb, sink, speed)
        self._has_requested_speed = (
            speed is not None,
            climb is not None,
            sink is not None,
            speed is not None,
        )
        maxima = (airframe.top_speed, airframe.top_climb, airframe.top_climb, limits.airspeed_max)
        defaults = (limits.speed, limits.climb, limits.sink, limits.airspeed_cruise)
        north, up, down, air = (
            finite(value, default, 0.05, max(maximum, 0.05))
            for value, default, maximum in zip(requested, defaults, maxima, strict=True)
        )
        return north, up, down, air

    # --- demands

    def _apply(self, demand: Demand) -> None:
        """Write a demand to the body's column."""
        world, column, mode = self._world, self.column, demand.mode
        world.state.data[_DEMAND, column] = demand.rows(demand.speeds or self._bounded_speeds(None))
        if (mode == Mode.STOP) is self.running:
            world.state.running[column] = float(mode != Mode.STOP)
            self._tick = -1
        yaw_mode, yaw = demand.yaw
        self._heading = yaw if yaw_mode == YawMode.HOLD else None

    def _yaw_demand(self, yaw: float | None, yaw_rate: float | None = None) -> tuple[float, float]:
        """Return the yaw mode and value: the yaw given, the rate given, or the heading held so far."""
        if yaw is None and yaw_rate is not None and math.isfinite(yaw_rate):
            return YawMode.RATE, finite(yaw_rate, 0.0, -6.0, 6.0)
        held = self._heading if self._heading is not None else self.estimate.yaw
        return YawMode.HOLD, angle(yaw, held)

    def stop(self) -> None:
        """Stop the motors: a flying vehicle falls."""
        self._apply(Demand(Mode.STOP))

    def idle(self) -> None:
        """Run the motors at idle, on the ground."""
        self._apply(Demand(Mode.IDLE))

    def roll_out(self) -> None:
        """Roll out after touch-down: no thrust, wings level, brakes on."""
        self._apply(Demand(Mode.ROLL_OUT))

    def _place(self, north: float, east: float, down: float) -> tuple[float, float, float]:
        """Return a finite position; vehicles on the surface keep their present height."""
        here = self.estimate
        if self.vehicle_type.on_surface:
            down = here.down
        return (
            finite(north, here.north, -MAX_DISTANCE, MAX_DISTANCE),
            finite(east, here.east, -MAX_DISTANCE, MAX_DISTANCE),
            finite(down, here.down, -MAX_DISTANCE, MAX_DISTANCE),
        )

    def go_to(
        self,
        north: float,
        east: float,
        down: float,
        *,
        start: tuple[float, float, float] | None = None,
        speed: float | None = None,
        climb: float | None = None,
        sink: float | None = None,
        yaw: float | None = None,
    ) -> None:
        """Fly a straight line to a point and stay there; a wing flies on along the line.

        Args:
            north: Metres north of the origin.
            east: Metres east of the origin.
            down: Metres below the origin.
            start: Where the line begins; None for the present position.
            speed: Horizontal speed in m/s; None for the limit, as for `climb` and `sink`.
            climb: Climb rate in m/s.
            sink: Sink rate in m/s.
            yaw: Heading in radians; None to look along the line, or to keep the heading on a short one.
        """
        target = self._place(north, east, down)
        begin = self.estimate[:3] if start is None else self._place(*start)
        direction, length = line(begin, target)
        yaws = self._yaw_demand(yaw)
        if yaw is None and math.hypot(direction[0], direction[1]) * length >= MIN_HEADING_LINE:
            yaws = YawMode.HOLD, math.atan2(direction[1], direction[0])
        speeds = self._bounded_speeds(speed, climb, sink)
        self._apply(
            Demand(
                Mode.LINE,
                target=target,
                start=begin,
                direction=direction,
                length=length,
                speeds=speeds,
                yaw=yaws,
            )
        )

    def fly_velocity(
        self,
        north: float,
        east: float,
        down: float,
        *,
        yaw: float | None = None,
        yaw_rate: float | None = None,
    ) -> None:
        """Fly at a velocity; a wing derives course, airspeed and climb rate from it.

        Args:
            north: m/s north.
            east: m/s east.
            down: m/s down.
            yaw: Heading in radians; None to keep the heading, or to turn at `yaw_rate`.
            yaw_rate: rad/s, used if `yaw` is None.
        """
        airframe = AIRFRAMES[self.vehicle_type]
        maximum = max(airframe.top_speed, self.limits.airspeed_max)
        north, east = finite(north, 0.0, -1e3, 1e3), finite(east, 0.0, -1e3, 1e3)
        shrink = min(1.0, maximum / max(math.hypot(north, east), 1e-9))
        vertical = finite(down, 0.0, -airframe.top_climb, airframe.top_climb)
        velocity = (north * shrink, east * shrink, vertical)
        if self.velocity_filter is not None:
            velocity = self.velocity_filter(*velocity)
        maxima = (airframe.top_speed, airframe.top_climb, airframe.top_climb, maximum)
        demanded = self._yaw_demand(yaw, yaw_rate)
        self._apply(Demand(Mode.VELOCITY, target=velocity, speeds=maxima, yaw=demanded))
        self._has_requested_speed = (True, True, True, False)
        self._world.state.speeds[3, self.column] = self.limits.airspeed_cruise

    def circle(
        self,
        north: float,
        east: float,
        down: float,
        radius: float,
        *,
        speed: float | None = None,
        yaw: float | None = None,
    ) -> None:
        """Fly a circle around a point.

        Args:
            north: Metres north of the origin to the centre.
            east: Metres east of the origin to the centre.
            down: Metres below the origin to the centre.
            radius: Metres; positive is clockwise seen from above.
            speed: m/s; None for the limit.
            yaw: Heading in radians; None to look at the centre.
        """
        bounded_radius = finite(radius, 0.0, -MAX_DISTANCE, MAX_DISTANCE)
        if bounded_radius == 0.0 and self.vehicle_type is VehicleType.PLANE:
            bounded_radius = self.limits.loiter_radius
        yaws = (YawMode.CENTRE, 0.0) if yaw is None else (YawMode.HOLD, angle(yaw, self.estimate.yaw))
        centre = self._place(north, east, down)
        speeds = self._bounded_speeds(speed)
        self._apply(Demand(Mode.CIRCLE, target=centre, speeds=speeds, radius=bounded_radius, yaw=yaws))

    def hold_attitude(
        self, roll: float, pitch: float, yaw: float | None, thrust: float, *, yaw_rate: float | None = None
    ) -> None:
        """Hold an attitude.

        Args:
            roll: Radians.
            pitch: Radians.
            yaw: Radians; None to keep the heading, or to turn at `yaw_rate`.
            thrust: 0 to 1 (copter: about 0.5 hovers; sub: 0.5 is no thrust).
            yaw_rate: rad/s, used if `yaw` is None.
        """
        yaws = self._yaw_demand(yaw, yaw_rate)
        lean = (angle(roll, 0.0), angle(pitch, 0.0), 0.0)
        self._apply(Demand(Mode.ATTITUDE, stick=(*lean, self._thrust(thrust, 0.0)), yaw=yaws))

    def hold_rates(self, roll_rate: float, pitch_rate: float, yaw_rate: float, thrust: float) -> None:
        """Turn at body rates in rad/s with a thrust of 0 to 1."""
        roll, pitch, yaw = (finite(rate, 0.0, -10.0, 10.0) for rate in (roll_rate, pitch_rate, yaw_rate))
        self._apply(Demand(Mode.RATES, stick=(roll, pitch, yaw, self._thrust(thrust, 0.0))))

    def sticks(self, roll: float, pitch: float, throttle: float, yaw: float) -> None:
        """Pass stick positions of -1 to 1 to the actuators.

        Args:
            roll: Positive to the right.
            pitch: Positive is nose up (sub: forward).
            throttle: -1 to 1, or 0 to 1 if the vehicle's motors cannot reverse.
            yaw: Positive to the right.
        """
        roll, pitch, yaw = (finite(stick, 0.0, -1.0, 1.0) for stick in (roll, pitch, yaw))
        minimum = -1.0 if self.vehicle_type in _REVERSES else 0.0
        self._apply(Demand(Mode.STICKS, stick=(roll, pitch, yaw, self._thrust(throttle, minimum))))

    def _thrust(self, thrust: float, minimum: float) -> float:
        """Return a thrust within its range."""
        return finite(thrust, 0.0, minimum, 1.0)

    def transition_to(self, forward: bool) -> None:
        """Start a VTOL's transition to forward flight or back to hover; other types ignore it."""
        if self.vehicle_type is VehicleType.VTOL:
            state = self._world.state
            state.forward_requested[self.column] = float(forward)
            if not forward:
                self._heading = self.estimate.yaw
                state.yaw_demand[self.column] = self._heading

    # --- faults, and other operations without an equivalent on a real vehicle

    def _fault(self, name: str, *values: float) -> None:
        """Write the rows of a fault."""
        self._world.state.data[_ROWS[name], self.column] = values
        self._invalidate()

    def fail_gps(self, failed: bool = True) -> None:
        """Fail or restore the GPS receiver."""
        self._gps_failed = failed
        self._apply_gps_faults()

    def spoof_gps(self, north: float, east: float) -> None:
        """Offset the GPS position by metres north and east."""
        self._gps_offset = finite(north, 0.0, -1e5, 1e5), finite(east, 0.0, -1e5, 1e5)
        self._apply_gps_faults()

    def correct_gps(self, fix: int) -> None:
        """Let the body's own receiver use corrections: GPS_FIX_TYPE 5 (float) or 6 (fixed), 0: none."""
        self._fault("gps_fix", float(fix))
        self._fault("gps_precision", PRECISION.get(fix, 0.0))

    def _apply_gps_faults(self) -> None:
        """Apply the faults of the body's own receiver while the estimate follows it."""
        if self._gps_report is None:
            self._fault("gps_lost", float(self._gps_failed))
            self._fault("spoof", *self._gps_offset, 0.0)

    def replace_gps(self, report: GpsReport | None) -> None:
        """Let the estimate follow a receiver outside the simulation instead of the body's own.

        Between two reports the estimate moves with the body, as inertial navigation does.

        Args:
            report: The report; without a 3D fix the position is lost. None returns to the own receiver.
        """
        was_lost = self._gps_report is None or self._gps_report.gps_fix < FIX_3D
        self._gps_report = report
        if report is None:
            self._apply_gps_faults()
            return
        fixed = report.gps_fix >= FIX_3D
        self._fault("gps_lost", float(not fixed))
        if not fixed:
            return
        north, east, _ = self.frame.to_local(report.gps_latitude, report.gps_longitude, 0.0)
        offset = self._offset_from_truth(north, east)
        self._fault("spoof", *offset, 0.0)
        if was_lost:  # use the first position at once; the estimate approaches later positions gradually
            self._world.state.position_error[:2, self.column] = offset

    use_gps = aiding.use_gps
    aid = aiding.aid

    def _offset_from_truth(self, north: float, east: float) -> tuple[float, float]:
        """Return the offset of a given position from the true one, in metres."""
        truth = self.truth
        return (
            finite(north - truth.north, 0.0, -MAX_DISTANCE, MAX_DISTANCE),
            finite(east - truth.east, 0.0, -MAX_DISTANCE, MAX_DISTANCE),
        )

    def offset_compass(self, radians: float) -> None:
        """Offset the compass heading by an angle in radians."""
        self._fault("compass_offset", angle(radians, 0.0))

    def sag_battery(self, volts: float) -> None:
        """Reduce the battery voltage by some volts."""
        self._fault("sag", finite(volts, 0.0, 0.0, 60.0))

    def drift_barometer(self, metres: float) -> None:
        """Make the barometer read a height that is too low by `metres` (down too great)."""
        self._fault("baro_drift", finite(metres, 0.0, -1e4, 1e4))

    def fail_motor(self, number: int, failed: bool = True) -> None:
        """Fail or restore a motor, counted from 1; a number that no motor has changes nothing."""
        if not 1 <= number <= AIRFRAMES[self.vehicle_type].motors:
            return
        (self._failed_motors.add if failed else self._failed_motors.discard)(number)
        failure = faults.motor_failure(self.vehicle_type, self._failed_motors)
        self._fault("lift_left", failure.lift)
        self._fault("drive_left", failure.drive)
        self._fault("spin", failure.spin)
        self._fault("lean", failure.lean[0], failure.lean[1], 0.0)

    def set_wind(self, speed: float, direction: float = 0.0, turbulence: float = 0.0) -> None:
        """Set the wind of the world, which all bodies share.

        Args:
            speed: m/s.
            direction: Where the wind comes from, in degrees.
            turbulence: Standard deviation of the gusts as a share of the speed.
        """
        self._world.set_wind(speed, direction, turbulence)

    def place(self, north: float, east: float, down: float, yaw: float) -> None:
        """Move the body to a position, at rest and level."""
        position = self._place(north, east, down)
        self._world.place(self.column, position, angle(yaw, 0.0))
        self._heading = None
        self._invalidate()

    def recharge(self, remaining: float = 1.0) -> None:
        """Set the battery's state of charge, 0 to 1."""
        share = finite(remaining, 1.0, 0.0, 1.0)
        self._fault("consumed", (1.0 - share) * self.battery.capacity)
        self._fault("remaining", share)
