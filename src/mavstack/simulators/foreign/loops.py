"""Inner loops: from the demand of the control laws to the outputs of a foreign body.

Nothing is known of that body but its kind, so the gains are moderate: about half of those with which PX4
flies its own vehicles, for simulators that make steps of 10 ms and motors that take 50 ms. The share of the
thrust that hovers is learned in flight.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, Protocol

from mavstack.rotation import rotate, to_euler
from mavstack.sim.vehicle_types import VehicleType
from mavstack.simulators.bodies.copter import MOTORS
from mavstack.simulators.state import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.rotation import Vector
    from mavstack.sim.motion.external import ActuatorDemand
    from mavstack.simulators.foreign.sample import ForeignSample


class Loops(Protocol):
    """The inner loops of a kind of vehicle."""

    def step(self, sample: ForeignSample, demand: ActuatorDemand, dt: float) -> list[float]:
        """Return the outputs: motors 0 to 1, others -1 to 1; see `mavstack.simulators.outputs`."""

    def stop(self) -> list[float]:
        """Return the outputs of a vehicle whose motors are stopped, and forget what was learned of errors."""

    def pulses(self, outputs: Sequence[float]) -> list[int]:
        """Return outputs as ArduPilot's servo pulses in microseconds."""


class CopterLoops:
    """Attitude and rates of a quadrotor."""

    #: Gains: rate per angle; torque per rate, per integral of the rate and per change of the rate; and the
    #: limits.
    ANGLE: Final = (4.5, 4.5)
    RATE: Final = (0.08, 0.08, 0.15)
    INTEGRAL: Final = (0.12, 0.12, 0.08)
    DERIVATIVE: Final = (0.003, 0.003, 0.0)
    MAX_RATE, MAX_INTEGRAL, MAX_TORQUE = 3.8, 0.3, 0.4

    def __init__(self) -> None:
        self._hover = 0.5
        self._integral = [0.0, 0.0, 0.0]
        self._last: Vector | None = None

    def stop(self) -> list[float]:
        """Return motors that are stopped; see `Loops`."""
        self._integral, self._last = [0.0, 0.0, 0.0], None
        return [0.0] * len(MOTORS)

    def step(self, sample: ForeignSample, demand: ActuatorDemand, dt: float) -> list[float]:
        """Return the motors; see `Loops`."""
        thrust = min(demand.lift * 2.0 * self._hover, 0.95)
        roll, pitch, yaw = self._torque(sample, demand, dt)
        motors = [thrust - right * roll + forward * pitch + turn * yaw for forward, right, turn in MOTORS]
        shift = max(0.0, -min(motors)) - max(0.0, max(motors) - 1.0)
        motors = [min(max(motor + shift, 0.0), 1.0) for motor in motors]
        self._learn(sample, sum(motors) / len(motors), dt)
        return motors

    def pulses(self, outputs: Sequence[float]) -> list[int]:
        """Return motors as pulses; see `Loops`."""
        return [round(1000.0 + 1000.0 * value) for value in outputs]

    def _torque(self, sample: ForeignSample, demand: ActuatorDemand, dt: float) -> list[float]:
        roll, pitch, _ = to_euler(sample.attitude)
        limit = self.MAX_RATE
        roll_rate = max(-limit, min(limit, self.ANGLE[0] * (demand.roll - roll)))
        pitch_rate = max(-limit, min(limit, self.ANGLE[1] * (demand.pitch - pitch)))
        turn = demand.yaw_rate * math.cos(pitch)
        wanted = (
            roll_rate - demand.yaw_rate * math.sin(pitch),
            pitch_rate * math.cos(roll) + turn * math.sin(roll),
            turn * math.cos(roll) - pitch_rate * math.sin(roll),
        )
        last, self._last = self._last or sample.rates, sample.rates
        torque = []
        for axis in range(3):
            error = wanted[axis] - sample.rates[axis]
            bounded = self._integral[axis] + self.INTEGRAL[axis] * error * dt
            self._integral[axis] = max(-self.MAX_INTEGRAL, min(self.MAX_INTEGRAL, bounded))
            change = (sample.rates[axis] - last[axis]) / dt if dt > 0.0 else 0.0
            value = self.RATE[axis] * error + self._integral[axis] - self.DERIVATIVE[axis] * change
            torque.append(max(-self.MAX_TORQUE, min(self.MAX_TORQUE, value)))
        return torque

    def _learn(self, sample: ForeignSample, share: float, dt: float) -> None:
        """Learn the share that hovers, from the force that the motors make in flight."""
        up = -sample.force[2]
        if share < 0.1 or up < 0.3 * GRAVITY or -sample.position[2] < 0.5:
            return
        hover = share * GRAVITY / up
        self._hover += (min(max(hover, 0.1), 0.9) - self._hover) * min(dt, 0.1)


class PlaneLoops:
    """Attitude of a plane by aileron, elevator, throttle and rudder."""

    ROLL, ROLL_DAMPING = 1.2, 0.25
    PITCH, PITCH_INTEGRAL, PITCH_DAMPING = 1.8, 0.8, 0.4
    YAW, MAX_INTEGRAL = 1.2, 0.4
    #: Airspeed in m/s for which the gains are tuned; a lower airspeed needs larger deflections.
    SPEED: Final = 22.0

    def __init__(self) -> None:
        self._integral = 0.0

    def stop(self) -> list[float]:
        """Return neutral surfaces; see `Loops`."""
        self._integral = 0.0
        return [0.0] * 4

    def step(self, sample: ForeignSample, demand: ActuatorDemand, dt: float) -> list[float]:
        """Return aileron, elevator, throttle and rudder; see `Loops`."""
        roll, pitch, _ = to_euler(sample.attitude)
        p, q, r = sample.rates
        speed = math.hypot(*sample.velocity)
        scale = min(max(self.SPEED / max(speed, 1.0), 0.5), 1.5)
        error = demand.pitch - pitch
        bounded = self._integral + self.PITCH_INTEGRAL * error * dt
        self._integral = max(-self.MAX_INTEGRAL, min(self.MAX_INTEGRAL, bounded))
        aileron = scale * (self.ROLL * (demand.roll - roll) - self.ROLL_DAMPING * p)
        elevator = scale * (self.PITCH * error - self.PITCH_DAMPING * q) + self._integral
        rudder = self.YAW * (demand.yaw_rate - r)
        throttle = min(max(demand.drive, 0.0), 1.0)
        return [_unit(aileron), _unit(elevator), throttle, _unit(rudder)]

    def pulses(self, outputs: Sequence[float]) -> list[int]:
        """Return surfaces and throttle as pulses; see `Loops`."""
        pulses = [round(1500.0 + 500.0 * value) for value in outputs]
        pulses[2] = round(1000.0 + 1000.0 * outputs[2])
        return pulses


class RoverLoops:
    """Steering and throttle of a rover or a boat."""

    #: Steering per turn rate (rad/s) at 1 m/s, and per error of the turn rate.
    TURN, ERROR = 1.1, 0.4

    def stop(self) -> list[float]:
        """Return centred steering and no throttle; see `Loops`."""
        return [0.0, 0.0]

    def step(self, sample: ForeignSample, demand: ActuatorDemand, dt: float) -> list[float]:
        """Return steering and throttle; see `Loops`."""
        forward = rotate(sample.attitude, (1.0, 0.0, 0.0))
        speed = sum(a * b for a, b in zip(forward, sample.velocity, strict=True))
        turn = self.TURN * demand.yaw_rate / max(abs(speed), 1.0) * math.copysign(1.0, speed or 1.0)
        error = self.ERROR * (demand.yaw_rate - sample.rates[2])
        return [_unit(turn + error), _unit(demand.drive)]

    def pulses(self, outputs: Sequence[float]) -> list[int]:
        """Return steering at output 1 and throttle at output 3; see `Loops`."""
        steering, throttle = (round(1500.0 + 500.0 * value) for value in outputs)
        return [steering, 0, throttle]


def _unit(value: float) -> float:
    return max(-1.0, min(1.0, value))


LOOPS: Final[Mapping[VehicleType, Callable[[], Loops]]] = {
    VehicleType.COPTER: CopterLoops,
    VehicleType.PLANE: PlaneLoops,
    VehicleType.ROVER: RoverLoops,
    VehicleType.BOAT: RoverLoops,
}
