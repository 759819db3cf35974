"""A handle of one body: what it reads as (`BodyReader`), demands, limits and faults.

A demand is one assignment to the body's column and holds until the next; the world's step flies it. A yaw
not given keeps the heading last held; a line long enough gives its own.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavstack.sim.motion import faults
from mavstack.sim.motion.airframes import AIRFRAMES, limit_range
from mavstack.sim.motion.body_reader import BodyReader
from mavstack.sim.motion.demands import MAX_DISTANCE, MIN_HEADING_LINE, Mode, YawMode, angle, finite, line
from mavstack.sim.motion.readings import Limits
from mavstack.sim.motion.state import StateArray
from mavstack.sim.vehicle_types import Home, VehicleType

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.sim.motion.world import World

_ROWS = {name: slice(first, first + count) for name, (first, count) in StateArray.ROWS.items()}
_LIMITS = slice(_ROWS["speed"].start, _ROWS["speed"].start + len(Limits._fields))
_DEMAND = slice(_ROWS["mode"].start, _ROWS["forward_requested"].start)
_NOWHERE = (0.0, 0.0, 0.0)
_STILL = (0.0, 0.0, 0.0, 0.0)
_REVERSES = (VehicleType.ROVER, VehicleType.BOAT, VehicleType.SUB)
_SPEED_LIMITS = ("speed", "climb", "sink", "airspeed_cruise")


class Body(BodyReader):
    """One simulated body of a world."""

    def __init__(self, world: World, vehicle_type: VehicleType, home: Home, number: int) -> None:
        super().__init__(world, vehicle_type, home, number)
        self._heading: float | None = None
        self._given_speeds = (False, False, False, False)
        self._failed_motors: set[int] = set()

    # --- limits

    def set_limit(self, name: str, value: float) -> None:
        """Set one of the figures of `Limits`; a value beyond what makes sense is bounded."""
        low, high = limit_range(self.type, name)
        before = self.limits
        values = before._replace(**{name: finite(value, getattr(before, name), low, high)})
        if name == "speed" and self.type is VehicleType.PLANE:
            values = values._replace(airspeed_cruise=values.speed)
        state = self._world.state
        state.data[_LIMITS, self.column] = values
        for row, own in enumerate(self._given_speeds):
            if not own:
                state.speeds[row, self.column] = getattr(values, _SPEED_LIMITS[row])
        self._invalidate()

    def _bounded_speeds(
        self, speed: float | None, climb: float | None = None, sink: float | None = None
    ) -> tuple[float, float, float, float]:
        """Bound what is asked by what the airframe can; the limits for what is not."""
        limits, figure = self.limits, AIRFRAMES[self.type]
        asked = (speed, climb, sink, speed)
        self._given_speeds = (speed is not None, climb is not None, sink is not None, speed is not None)
        tops = (figure.top_speed, figure.top_climb, figure.top_climb, limits.airspeed_max)
        defaults = (limits.speed, limits.climb, limits.sink, limits.airspeed_cruise)
        north, up, down, air = (
            finite(value, default, 0.05, max(top, 0.05))
            for value, default, top in zip(asked, defaults, tops, strict=True)
        )
        return north, up, down, air

    # --- demands

    def _demand(
        self,
        mode: float,
        *,
        target: Sequence[float] = _NOWHERE,
        start: Sequence[float] = _NOWHERE,
        along: Sequence[float] = _NOWHERE,
        size: float = 0.0,
        pace: Sequence[float] | None = None,
        radius: float = 0.0,
        yaw: tuple[float, float] = (YawMode.RATE, 0.0),
        stick: Sequence[float] = _STILL,
    ) -> None:
        paces = self._bounded_speeds(None) if pace is None else pace
        values = (mode, *target, *start, *along, size, *paces, radius, *yaw, *stick)
        world = self._world
        world.state.data[_DEMAND, self.column] = values
        if (mode == Mode.STOP) is self.running:
            world.state.running[self.column] = float(mode != Mode.STOP)
            self._tick = -1
        self._heading = yaw[1] if yaw[0] == YawMode.HOLD else None

    def _yaw_demand(self, yaw: float | None, yaw_rate: float | None = None) -> tuple[float, float]:
        """Say what yaw to fly: the one given, the rate given, or the heading held so far."""
        if yaw is None and yaw_rate is not None and math.isfinite(yaw_rate):
            return YawMode.RATE, finite(yaw_rate, 0.0, -6.0, 6.0)
        held = self._heading if self._heading is not None else self.estimate.yaw
        return YawMode.HOLD, angle(yaw, held)

    def stop(self) -> None:
        """Motors off: what flies, falls."""
        self._demand(Mode.STOP)

    def idle(self) -> None:
        """Motors idle, on the ground."""
        self._demand(Mode.IDLE)

    def roll_out(self) -> None:
        """After touch-down: no thrust, wings level, brakes."""
        self._demand(Mode.ROLL_OUT)

    def _place(self, north: float, east: float, down: float) -> tuple[float, float, float]:
        """What drives stays on its surface, whatever altitude a waypoint has."""
        here = self.estimate
        if self.type.on_surface:
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
        """Fly the line from `start` (or from here) to a point, and stay; a wing flies on along the line."""
        target = self._place(north, east, down)
        begin = self.estimate[:3] if start is None else self._place(*start)
        along, size = line(begin, target)
        yaws = self._yaw_demand(yaw)
        if yaw is None and math.hypot(along[0], along[1]) * size >= MIN_HEADING_LINE:
            yaws = YawMode.HOLD, math.atan2(along[1], along[0])
        pace = self._bounded_speeds(speed, climb, sink)
        self._demand(Mode.LINE, target=target, start=begin, along=along, size=size, pace=pace, yaw=yaws)

    def fly_velocity(
        self,
        north: float,
        east: float,
        down: float,
        *,
        yaw: float | None = None,
        yaw_rate: float | None = None,
    ) -> None:
        """Fly at a velocity; a wing takes course, airspeed and climb from it."""
        figure = AIRFRAMES[self.type]
        most = max(figure.top_speed, self.limits.airspeed_max)
        north, east = finite(north, 0.0, -1e3, 1e3), finite(east, 0.0, -1e3, 1e3)
        shrink = min(1.0, most / max(math.hypot(north, east), 1e-9))
        vertical = finite(down, 0.0, -figure.top_climb, figure.top_climb)
        tops = (figure.top_speed, figure.top_climb, figure.top_climb, most)
        self._demand(
            Mode.VELOCITY,
            target=(north * shrink, east * shrink, vertical),
            pace=tops,
            yaw=self._yaw_demand(yaw, yaw_rate),
        )
        self._given_speeds = (True, True, True, False)
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
        """Fly a circle around a point, clockwise seen from above if `radius` > 0; yaw None: to the centre."""
        around = finite(radius, 0.0, -MAX_DISTANCE, MAX_DISTANCE)
        if around == 0.0 and self.type is VehicleType.PLANE:
            around = self.limits.loiter_radius
        yaws = (YawMode.CENTRE, 0.0) if yaw is None else (YawMode.HOLD, angle(yaw, self.estimate.yaw))
        self._demand(
            Mode.CIRCLE,
            target=self._place(north, east, down),
            pace=self._bounded_speeds(speed),
            radius=around,
            yaw=yaws,
        )

    def hold_attitude(
        self, roll: float, pitch: float, yaw: float | None, thrust: float, *, yaw_rate: float | None = None
    ) -> None:
        """Hold an attitude with a thrust of 0 to 1 (copter: half hovers; sub: half is none)."""
        yaws = self._yaw_demand(yaw, yaw_rate)
        lean = (angle(roll, 0.0), angle(pitch, 0.0), 0.0)
        self._demand(Mode.ATTITUDE, stick=(*lean, self._thrust(thrust, 0.0)), yaw=yaws)

    def hold_rates(self, roll_rate: float, pitch_rate: float, yaw_rate: float, thrust: float) -> None:
        """Turn at body rates with a thrust of 0 to 1."""
        rates = (finite(rate, 0.0, -10.0, 10.0) for rate in (roll_rate, pitch_rate, yaw_rate))
        self._demand(Mode.RATES, stick=(*rates, self._thrust(thrust, 0.0)))

    def sticks(self, roll: float, pitch: float, throttle: float, yaw: float) -> None:
        """Pass -1..1 to the actuators; pitch > 0 is nose up (sub: forward), a throttle of a motor that
        cannot reverse is 0..1.
        """
        hands = (finite(stick, 0.0, -1.0, 1.0) for stick in (roll, pitch, yaw))
        least = -1.0 if self.type in _REVERSES else 0.0
        self._demand(Mode.STICKS, stick=(*hands, self._thrust(throttle, least)))

    def _thrust(self, thrust: float, least: float) -> float:
        return finite(thrust, 0.0, least, 1.0)

    def transition_to(self, forward: bool) -> None:
        """Go over to flight on the wing, or back to hover; nothing for what is no VTOL."""
        if self.type is VehicleType.VTOL:
            state = self._world.state
            state.forward_requested[self.column] = float(forward)
            if not forward:
                self._heading = self.estimate.yaw
                state.yaw_demand[self.column] = self._heading

    # --- faults, and what only a simulation can do

    def _fault(self, name: str, *values: float) -> None:
        self._world.state.data[_ROWS[name], self.column] = values
        self._invalidate()

    def fail_gps(self, failed: bool = True) -> None:
        """Lose the GPS, or find it again."""
        self._fault("gps_lost", float(failed))

    def spoof_gps(self, north: float, east: float) -> None:
        """Have the GPS report a place off by metres."""
        places = finite(north, 0.0, -1e5, 1e5), finite(east, 0.0, -1e5, 1e5)
        self._fault("spoof", *places, 0.0)

    def offset_compass(self, radians: float) -> None:
        """Have the compass read a heading off by an angle."""
        self._fault("compass_offset", angle(radians, 0.0))

    def sag_battery(self, volts: float) -> None:
        """Have the battery's voltage fall by some volts."""
        self._fault("sag", finite(volts, 0.0, 0.0, 60.0))

    def drift_barometer(self, metres: float) -> None:
        """Have the barometer read a height that much too low (down too great)."""
        self._fault("baro_drift", finite(metres, 0.0, -1e4, 1e4))

    def fail_motor(self, number: int, failed: bool = True) -> None:
        """Stop a motor (from 1), or let it run again; a number no motor has changes nothing."""
        if not 1 <= number <= AIRFRAMES[self.type].motors:
            return
        (self._failed_motors.add if failed else self._failed_motors.discard)(number)
        damage = faults.motor_failure(self.type, self._failed_motors)
        self._fault("lift_left", damage.lift)
        self._fault("drive_left", damage.drive)
        self._fault("spin", damage.spin)
        self._fault("lean", damage.lean[0], damage.lean[1], 0.0)

    def set_wind(self, speed: float, direction: float = 0.0, turbulence: float = 0.0) -> None:
        """Let the wind of its world set_wind, which is that of all bodies."""
        self._world.set_wind(speed, direction, turbulence)

    def place(self, north: float, east: float, down: float, yaw: float) -> None:
        """Put it somewhere, at rest and level."""
        where = self._place(north, east, down)
        self._world.place(self.column, where, angle(yaw, 0.0))
        self._heading = None
        self._invalidate()

    def recharge(self, remaining: float = 1.0) -> None:
        """Fill its battery up to a share."""
        share = finite(remaining, 1.0, 0.0, 1.0)
        self._fault("consumed", (1.0 - share) * self.battery.capacity)
        self._fault("remaining", share)
