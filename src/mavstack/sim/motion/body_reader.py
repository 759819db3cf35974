"""What can be read of a body.

Reading copies the published part of the body's column once a step; everything read in that step comes from
this copy, and each vehicle_type of value is put together at most once a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.motion import estimate, servos
from mavstack.sim.motion.geodesy import LocalFrame
from mavstack.sim.motion.readings import (
    BatteryState,
    EstimateHealth,
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
_BATTERY = slice(_FIRST["voltage"], _FIRST["voltage"] + 5)
_CELLS, _CAPACITY = _FIRST["cells"], _FIRST["capacity"]
_LIMITS = slice(_FIRST["speed"], _FIRST["speed"] + len(Limits._fields))


class BodyReader:
    """One body of a world, as it can be read."""

    def __init__(self, world: World, vehicle_type: VehicleType, home: Home, number: int) -> None:
        self.type = vehicle_type
        self.home = home
        self.number = number
        self.frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        #: Where its numbers are; the world moves them when it grows.
        self.column = 0
        self._world = world
        self._tick = -1
        self._values: list[float] = []
        self._truth: Motion | None = None
        self._estimate: Motion | None = None

    def _read(self) -> list[float]:
        if self._tick != self._world.tick:
            self._values = self._world.state.data[:PUBLISHED, self.column].tolist()
            self._truth = self._estimate = None
            self._tick = self._world.tick
        return self._values

    def _invalidate(self) -> None:
        """Read anew: something was set between steps."""
        self._tick = -1
        self._world.sensors.invalidate()

    @property
    def truth(self) -> Motion:
        """Where it really is."""
        values = self._read()
        if self._truth is None:
            self._truth = Motion._make(values[:15])
        return self._truth

    @property
    def estimate(self) -> Motion:
        """Where its autopilot believes it is."""
        values = self._read()
        if self._estimate is None:
            place, turned = values[_ESTIMATE : _ESTIMATE + 6], values[_ESTIMATE + 6 : _ESTIMATE + 9]
            self._estimate = Motion(*place, *values[6:9], *turned, *values[12:15])
        return self._estimate

    @property
    def health(self) -> EstimateHealth:
        """How good the estimate is."""
        return estimate.assess(self._read())

    @property
    def airspeed(self) -> float:
        """Speed through the air in m/s."""
        return self._read()[_AIRSPEED]

    @property
    def wind(self) -> Wind:
        """The air's velocity here."""
        return Wind._make(self._read()[_AIR : _AIR + 3])

    @property
    def throttle(self) -> float:
        """Share of the full thrust in use, 0 to 1."""
        return self._read()[_THROTTLE]

    @property
    def on_ground(self) -> bool:
        """Whether it rests: on ground or water, a sub on the bottom or afloat."""
        return self._read()[_GROUND] > 0.0

    @property
    def transition(self) -> float:
        """VTOL: 0 in hover, 1 on its wing; 0 for copters and all that never fly, 1 for planes."""
        return 1.0 if self.type is VehicleType.PLANE else self._read()[_TRANSITION]

    @property
    def flies_forward(self) -> bool:
        """Whether it flies on a wing, or is told to."""
        if self.type is VehicleType.VTOL:
            return bool(self._world.state.forward_requested[self.column] > 0.0)
        return self.type is VehicleType.PLANE

    @property
    def running(self) -> bool:
        """Whether motors may turn."""
        return self._read()[_RUNNING] > 0.0

    @property
    def servos(self) -> tuple[int, ...]:
        """Sixteen PWM outputs in microseconds."""
        values = self._read()
        turning = (values[_CONTROLS], values[_CONTROLS + 1], values[_CONTROLS + 2])
        running = values[_RUNNING] > 0.0
        return servos.outputs(self.type, turning, values[_LIFT], values[_DRIVE], running)

    @property
    def battery(self) -> BatteryState:
        """The state of the battery."""
        values = self._read()
        return BatteryState._make((*values[_BATTERY], values[_CAPACITY], int(values[_CELLS])))

    @property
    def sensors(self) -> SensorReadings:
        """What the sensors read in this step."""
        world = self._world
        return readings(world.sensor_values(self.column), self._read(), self.frame)

    @property
    def limits(self) -> Limits:
        """Its limits of the moment; `set_limit` changes one."""
        return Limits._make(self._read()[_LIMITS])
