"""Betaflight's SITL: the packets of its UDP interface. Sans-IO.

| port | direction | packet |
|---|---|---|
| 9002 | from Betaflight | four motors, 0 to 1, as floats |
| 9003 | to Betaflight | 18 doubles: time, gyroscope, accelerometer, attitude, velocity, position, pressure |
| 9004 | to Betaflight | a double (time) and 16 channels of the transmitter in microseconds |

Betaflight is not in lockstep: it runs by its own clock and takes the latest packet. Its default build expects
what Gazebo's plugin sends: a gyroscope in forward and right whose yaw is positive to the left; an
accelerometer whose forward axis is turned round; an attitude that is turned by 90 degrees; a position in
degrees that is mirrored around the first one. Builds for X-Plane and RealFlight (`ENABLE_GAZEBO_BRIDGE` 0)
expect the true values. Comments of the build take the default's yaw for positive to the right; but then its
controller spins a body whose propellers turn as its own mixer assumes (front ones inward), as flights showed.

Motors come in Betaflight's order (rear right, front right, rear left, front left); before 2026 the SITL sent
them in the order of ArduPilot and PX4.
"""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Quaternion
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.sensors import Fix, Readings, SensorSource
    from mavstack.simulators.state import State

_FDM: Final = struct.Struct("<18d")
_MOTORS: Final = struct.Struct("<4f")
_RC: Final = struct.Struct("<d16H")
#: The index of Betaflight's motor for each motor of a body: front right, rear left, front left, rear right.
_ORDERS: Final = {"betaflight": (1, 2, 3, 0), "gazebo": (0, 1, 2, 3)}
BRIDGES: Final = ("gazebo", "legacy")
MOTOR_ORDERS: Final = tuple(_ORDERS)
#: Coordinate in degrees that Betaflight does not accept as a position.
_NOWHERE: Final = 999.0
_HALF: Final = math.sqrt(0.5)
#: Channels of a transmitter that is on: roll, pitch and yaw centred, throttle low, switches off.
NEUTRAL_STICKS: Final = (1500, 1500, 1000, 1500, *[1000] * 12)


class BetaflightInterface:
    """The conversation with one Betaflight.

    Args:
        sensors: The sensors of the body.
        home: Its place at the start.
        bridge: What the build expects: "gazebo" (the default build) or "legacy".
        motors: The order of the motors: "betaflight" (since 2026) or "gazebo".

    Attributes:
        controls: The outputs of the four motors of the body, 0 to 1.
        answers: Packets of motors that were received.
        invalid: Packets that are not of Betaflight.

    Raises:
        InvalidArgumentError: There is no such bridge or order.
    """

    def __init__(
        self, sensors: SensorSource, home: Home, *, bridge: str = "gazebo", motors: str = "betaflight"
    ) -> None:
        if bridge not in BRIDGES:
            raise InvalidArgumentError(f"there is no bridge {bridge!r}: {', '.join(BRIDGES)}")
        if motors not in _ORDERS:
            raise InvalidArgumentError(f"there is no motor order {motors!r}: {', '.join(_ORDERS)}")
        self._sensors, self._is_gazebo = sensors, bridge == "gazebo"
        self._order = _ORDERS[motors]
        self._origin = (home.latitude, home.longitude)
        self._fix: Fix | None = None
        self._altitude = home.altitude
        self.controls: tuple[float, ...] = (0.0,) * 4
        self.answers = self.invalid = 0

    def feed(self, data: bytes) -> bool:
        """Take a packet of motors; returns False if it is not one."""
        if len(data) != _MOTORS.size:
            self.invalid += 1
            return False
        values = _MOTORS.unpack(data)
        if not all(map(math.isfinite, values)):
            self.invalid += 1
            return False
        self.controls = tuple([min(max(values[index], 0.0), 1.0) for index in self._order])
        self.answers += 1
        return True

    def step(self, state: State, time: float, *, clock: float | None = None) -> bytes:
        """Return the packet of a step.

        Args:
            state: The state of the body.
            time: Seconds of the simulation.
            clock: The time in the packet, by which Betaflight sets its clock; None: `time`.
        """
        readings = self._sensors.sample(state, time)
        self._fix = readings.fix or self._fix
        if readings.altitude is not None:
            self._altitude = readings.altitude
        p, q, r = readings.rates
        ax, ay, az = readings.acceleration
        return _FDM.pack(
            time if clock is None else clock,
            p,
            q,
            -r if self._is_gazebo else r,
            -ax,
            ay,
            az,
            *self._attitude(state.attitude),
            *self._velocity(state),
            *self._position(readings),
            100.0 * self._sensors.atmosphere.pressure_at(self._altitude),
        )

    def _attitude(self, attitude: Quaternion) -> Quaternion:
        """Return the attitude from forward, left, up to north, west, up, or as Gazebo's bridge sends it."""
        w, x, y, z = attitude[0], attitude[1], -attitude[2], -attitude[3]
        if not self._is_gazebo:
            return w, x, y, z
        # Rotated by -90 degrees about up, then by 180 degrees about forward in the world and in the body.
        return _HALF * (w + z), _HALF * (x + y), -_HALF * (y - x), -_HALF * (z - w)

    def _velocity(self, state: State) -> tuple[float, float, float]:
        north, east, down = state.velocity if self._fix is None else self._fix.velocity
        return east, north, -down

    def _position(self, readings: Readings) -> tuple[float, float, float]:
        """Return longitude, latitude and altitude."""
        fix = self._fix
        if fix is None or not fix.is_valid:
            return _NOWHERE, _NOWHERE, self._altitude
        latitude, longitude = fix.latitude, fix.longitude
        if self._is_gazebo:
            latitude, longitude = 2 * self._origin[0] - latitude, 2 * self._origin[1] - longitude
        return longitude, latitude, fix.altitude


def encode_sticks(channels: Sequence[int], time: float) -> bytes:
    """Return the packet of a transmitter.

    Args:
        channels: Up to 16 channels in microseconds: roll, pitch, throttle, yaw, switches.
        time: Seconds of the simulation.

    Raises:
        InvalidArgumentError: There are more than 16 channels, or one is outside 0 to 3000 µs.
    """
    if len(channels) > len(NEUTRAL_STICKS) or not all(0 <= value <= 3000 for value in channels):
        raise InvalidArgumentError(
            f"the sticks must be up to {len(NEUTRAL_STICKS)} channels of 0 to 3000 us, got {list(channels)}"
        )
    return _RC.pack(time, *channels, *NEUTRAL_STICKS[len(channels) :])
