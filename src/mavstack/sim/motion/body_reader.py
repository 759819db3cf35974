"""Readable state of a body.

Reading copies the published part of the body's column once per step; everything read in that step comes from
this copy, and each value object is built at most once per step.
"""

from __future__ import annotations

from math import remainder, tau
from typing import TYPE_CHECKING

from mavstack.geodesy import LocalFrame
from mavstack.sim.motion import estimate, servos
from mavstack.sim.motion.attitude import YAW_SHARE
from mavstack.sim.motion.demands import Mode
from mavstack.sim.motion.obstacles import Surroundings
from mavstack.sim.motion.readings import (
    AttitudeSetpoint,
    BatteryState,
    EstimateHealth,
    GpsReport,
    Limits,
    Motion,
    SensorReadings,
    Wind,
)
from mavstack.sim.motion.sensors import readings
from mavstack.sim.motion.state import PUBLISHED, StateArray
from mavstack.sim.vehicle_types import Home, VehicleType

if TYPE_CHECKING:
    from mavstack.sim.motion.world import World

_FIRST = {name: first for name, (first, _) in StateArray.ROWS.items()}
_ESTIMATE = _FIRST["position_estimate"]
_AIR, _AIRSPEED, _THROTTLE = _FIRST["air"], _FIRST["airspeed"], _FIRST["throttle"]
_GROUND, _TRANSITION, _RUNNING = _FIRST["on_ground"], _FIRST["transition"], _FIRST["running"]
_CONTROLS, _LIFT, _DRIVE = _FIRST["controls"], _FIRST["lift_share"], _FIRST["drive_thrust"]
_SETPOINT = _FIRST["roll_setpoint"]
_BATTERY = slice(_FIRST["voltage"], _FIRST["voltage"] + 5)
_CELLS, _CAPACITY = _FIRST["cells"], _FIRST["capacity"]
_LIMITS = slice(_FIRST["speed"], _FIRST["speed"] + len(Limits._fields))


class BodyReader:
    """Read access to one body of a world."""

    def __init__(self, world: World, vehicle_type: VehicleType, home: Home, number: int) -> None:
        self.vehicle_type = vehicle_type
        self.home = home
        self.number = number
        self.frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        #: The body's column in the state array; it changes when bodies are added to the world.
        self.column = 0
        #: The ground and the obstacles around the body.
        self.surroundings = Surroundings()
        self._world = world
        self._tick = -1
        self._values: list[float] = []
        self._truth: Motion | None = None
        self._estimate: Motion | None = None
        self._gps_report: GpsReport | None = None
        #: The distance of a rangefinder outside the simulation in metres; None: the body's own counts.
        self.range_report: float | None = None
        #: The wind that a companion computer sent on the ground; None: the estimate is the true wind.
        self.wind_report: Wind | None = None

    def _read(self) -> list[float]:
        """Return the published part of the column, copied once per step."""
        if self._tick != self._world.tick:
            self._values = self._world.state.data[:PUBLISHED, self.column].tolist()
            self._truth = self._estimate = None
            self._tick = self._world.tick
        return self._values

    def _invalidate(self) -> None:
        """Discard the values of this step after a row was set between steps."""
        self._tick = -1
        self._world.sensors.invalidate()

    @property
    def truth(self) -> Motion:
        """True motion: metres, m/s, m/s2 and radians in the local frame (north, east, down)."""
        values = self._read()
        if self._truth is None:
            self._truth = Motion._make(values[:15])
        return self._truth

    @property
    def estimate(self) -> Motion:
        """Motion as the autopilot estimates it, in the units of `truth`."""
        values = self._read()
        if self._estimate is None:
            position, attitude = values[_ESTIMATE : _ESTIMATE + 6], values[_ESTIMATE + 6 : _ESTIMATE + 9]
            self._estimate = Motion(*position, *values[6:9], *attitude, *values[12:15])
        return self._estimate

    @property
    def attitude_setpoint(self) -> AttitudeSetpoint:
        """Attitude and body rates that the control loops ask for; the estimate while no motor may turn.

        A loop that is not in use asks for the present angle: both tilts while body rates are flown or on the
        surface, and the heading on a wing, whose turns come from its roll.
        """
        now, values = self.estimate, self._read()
        roll, pitch, turn, *rates = values[_SETPOINT : _SETPOINT + 6]
        if not self.running:
            return AttitudeSetpoint(*now[9:15])
        state, column = self._world.state, self.column
        on_surface = self.vehicle_type.on_surface
        if on_surface or state.mode[column] == Mode.RATES:
            roll, pitch = now.roll, now.pitch
        gain = float(state.attitude_gain[column]) * (1.0 if on_surface else YAW_SHARE)
        ahead = 0.0 if self.transition > 0.0 else turn / gain
        return AttitudeSetpoint(roll, pitch, remainder(now.yaw + ahead, tau), *rates)

    @property
    def health(self) -> EstimateHealth:
        """Health of the estimate."""
        return estimate.assess(self._read())

    @property
    def airspeed(self) -> float:
        """Airspeed in m/s."""
        return self._read()[_AIRSPEED]

    @property
    def wind(self) -> Wind:
        """Velocity of the air at the body in m/s, as the vehicle estimates it."""
        if self.wind_report is not None and self.on_ground:
            return self.wind_report
        return Wind._make(self._read()[_AIR : _AIR + 3])

    @property
    def throttle(self) -> float:
        """Share of the full thrust in use, 0 to 1."""
        return self._read()[_THROTTLE]

    @property
    def on_ground(self) -> bool:
        """True if the body rests on ground or water; for a sub, on the bottom or afloat."""
        return self._read()[_GROUND] > 0.0

    @property
    def transition(self) -> float:
        """Transition of a VTOL: 0 in hover, 1 on its wing.

        Planes are always 1; all other types 0.
        """
        return 1.0 if self.vehicle_type is VehicleType.PLANE else self._read()[_TRANSITION]

    @property
    def flies_forward(self) -> bool:
        """True if the body flies on a wing, or a VTOL has been commanded to."""
        if self.vehicle_type is VehicleType.VTOL:
            return bool(self._world.state.forward_requested[self.column] > 0.0)
        return self.vehicle_type is VehicleType.PLANE

    @property
    def running(self) -> bool:
        """True if motors may turn."""
        return self._read()[_RUNNING] > 0.0

    @property
    def servos(self) -> tuple[int, ...]:
        """Sixteen PWM outputs in microseconds."""
        values = self._read()
        turning = (values[_CONTROLS], values[_CONTROLS + 1], values[_CONTROLS + 2])
        running = values[_RUNNING] > 0.0
        return servos.outputs(self.vehicle_type, turning, values[_LIFT], values[_DRIVE], running)

    @property
    def battery(self) -> BatteryState:
        """State of the battery."""
        values = self._read()
        return BatteryState._make((*values[_BATTERY], values[_CAPACITY], int(values[_CELLS])))

    @property
    def sensors(self) -> SensorReadings:
        """Sensor readings of this step."""
        world = self._world
        own = readings(world.sensor_values(self.column), self._read(), self.frame)
        if self.range_report is not None:
            own = own._replace(distance=self.range_report)
        return own if self._gps_report is None else own._replace(**self._gps_report._asdict())

    @property
    def limits(self) -> Limits:
        """Present limits; `set_limit` changes one."""
        return Limits._make(self._read()[_LIMITS])
