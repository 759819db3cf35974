"""What others want a vehicle to fly to: `autopilot.guided`, filled by commands and by setpoints.

Setpoints come in many frames; here they become aims (`behaviours.aims`) in local metres, at the moment they
come, since some count from where the vehicle is or is turned to just then. Whether they are followed is the
mode's to say: a behaviour with `takes_setpoints`. A stream is watched in any mode, because one firmware
enters its offboard mode only when there already is one.
"""

from __future__ import annotations

from collections import deque
from math import cos, sin
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint, SetpointReceived
from mavstack.sim.autopilot.behaviours.guided_commands import Attitude, Axes, GoTo, GuidedCommand, Motion
from mavstack.sim.autopilot.behaviours.orbit import Orbit
from mavstack.sim.autopilot.behaviours.takeoff import Takeoff

if TYPE_CHECKING:
    from mavstack.services.setpoints import Setpoint
    from mavstack.sim.autopilot.control import RunningBehaviour
    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.autopilot.maneuvers import Point

_F = common.MavFrame
NOTHING: Axes = (None, None, None)
#: Frames whose axes are the vehicle's forward and right, and those whose positions count from where it is.
_TURNED = frozenset({_F.BODY_NED, _F.BODY_OFFSET_NED, _F.BODY_FRD, _F.LOCAL_FRD})
_FROM_HERE = frozenset({_F.LOCAL_OFFSET_NED, _F.BODY_NED, _F.BODY_OFFSET_NED, _F.BODY_FRD})
#: Setpoints that come less often than this are no stream.
STREAM_INTERVAL = 0.55
#: Nobody means more than this: metres, m/s.
_FAR, _HIGH, _FAST = 2.0e6, 1.0e5, 100.0


class GuidedTarget:
    """The newest aim of one vehicle."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self.aim: RunningBehaviour | None = None
        self._streamed: GuidedCommand | None = None
        self._heard_at: deque[float] = deque(maxlen=2)
        autopilot.vehicle.on(SetpointReceived, self._received)

    # By command

    def clear(self) -> None:
        """Nothing to fly to any more."""
        self.aim = None

    def go_to(
        self,
        point: Point,
        *,
        speed: float | None = None,
        radius: float | None = None,
        yaw: float | None = None,
    ) -> None:
        """Go to a point and stay there; a wing circles it with `radius`, negative: counter-clockwise."""
        self._pursue(GoTo(self._autopilot, point, speed=speed, radius=radius, yaw=yaw))

    def fly_velocity(
        self,
        north: float,
        east: float,
        down: float,
        *,
        yaw: float | None = None,
        yaw_rate: float | None = None,
    ) -> None:
        """Fly with a velocity until `flight_parameters.setpoint_timeout` has passed."""
        aim = Motion(self._autopilot, NOTHING, (north, east, down), NOTHING, yaw=yaw, yaw_rate=yaw_rate)
        self._pursue(aim)

    def orbit(
        self,
        centre: Point,
        radius: float,
        *,
        speed: float | None = None,
        yaw_behaviour: int = common.OrbitYawBehaviour.HOLD_FRONT_TO_CIRCLE_CENTER,
        turns: float | None = None,
    ) -> None:
        """Circle a point; radius > 0: clockwise."""
        self.aim = Orbit(
            self._autopilot, centre, radius, speed=speed, yaw_behaviour=yaw_behaviour, turns=turns
        )

    def take_off(
        self, altitude: float | None = None, *, down: float | None = None, yaw: float | None = None
    ) -> None:
        """Leave the ground and stay above it."""
        self.aim = Takeoff(self._autopilot, altitude, down=down, yaw=yaw)

    # By setpoints

    @property
    def stream_alive(self) -> bool:
        """Whether setpoints come more than twice a second, and lately."""
        if len(self._heard_at) < 2:
            return False
        before, last = self._heard_at
        patience = max(self._autopilot.flight_parameters.setpoint_timeout, STREAM_INTERVAL)
        return last - before <= STREAM_INTERVAL and self._autopilot.vehicle.now - last <= patience

    def follow_stream(self) -> None:
        """Fly after the newest setpoint of the stream."""
        self.aim = self._streamed if self.stream_alive else None

    def _received(self, event: SetpointReceived) -> None:
        self.set(event.setpoint)

    def set(self, setpoint: Setpoint) -> bool:
        """Take a setpoint; False if this vehicle cannot follow it."""
        aim = self._read(setpoint)
        if aim is None:
            return False
        self._heard_at.append(self._autopilot.vehicle.now)
        if self._streamed is None or not self._streamed.renew(aim):
            self._streamed = aim
        behaviour = self._autopilot.behaviour
        if behaviour is not None and behaviour.takes_setpoints:
            self._pursue(self._streamed)
        return True

    def _pursue(self, aim: GuidedCommand) -> None:
        if not (isinstance(self.aim, GuidedCommand) and (self.aim is aim or self.aim.renew(aim))):
            self.aim = aim

    def _read(self, setpoint: Setpoint) -> GuidedCommand | None:
        match setpoint:
            case AttitudeSetpoint():
                return Attitude(self._autopilot, setpoint)
            case GlobalSetpoint():
                return self._motion(setpoint, self._global_position(setpoint), setpoint.velocity)
            case LocalSetpoint() if setpoint.frame in self._autopilot.flight_parameters.setpoint_frames:
                position = self._local_position(setpoint)
                return self._motion(setpoint, position, self._turned(setpoint, setpoint.velocity))
        return None

    def _motion(
        self, setpoint: LocalSetpoint | GlobalSetpoint, position: Axes, velocity: Axes
    ) -> GuidedCommand:
        autopilot = self._autopilot
        position = _clamped(position, (_FAR, _FAR, _HIGH))
        velocity = _clamped(velocity, (_FAST, _FAST, _FAST))
        acceleration = _clamped(self._turned(setpoint, setpoint.acceleration), (_FAST, _FAST, _FAST))
        yaw = setpoint.yaw
        if yaw is not None and setpoint.frame in _TURNED:
            yaw += autopilot.body.estimate.yaw
        north, east, down = position
        rests = velocity == NOTHING and acceleration == NOTHING and setpoint.yaw_rate is None
        if rests and north is not None and east is not None and down is not None:
            return GoTo(autopilot, (north, east, down), yaw=yaw)
        drives = autopilot.vehicle.type.on_surface and setpoint.frame in _TURNED
        return Motion(
            autopilot,
            position,
            velocity,
            acceleration,
            yaw=yaw,
            yaw_rate=setpoint.yaw_rate,
            turns_along=drives,
        )

    def _turned(self, setpoint: LocalSetpoint | GlobalSetpoint, axes: Axes) -> Axes:
        """Axes of the vehicle as those of the ground; forward and right go together."""
        forward, right, down = axes
        if setpoint.frame not in _TURNED or (forward is None and right is None):
            return axes
        yaw = self._autopilot.body.estimate.yaw
        forward, right = forward or 0.0, right or 0.0
        return forward * cos(yaw) - right * sin(yaw), forward * sin(yaw) + right * cos(yaw), down

    def _local_position(self, setpoint: LocalSetpoint) -> Axes:
        north, east, down = self._turned(setpoint, setpoint.position)
        if setpoint.frame not in _FROM_HERE:
            return north, east, down
        here = self._autopilot.maneuvers.place
        return _sum(north, here[0]), _sum(east, here[1]), _sum(down, here[2])

    def _global_position(self, setpoint: GlobalSetpoint) -> Axes:
        frame = self._autopilot.body.frame
        north = east = down = None
        if setpoint.latitude is not None and setpoint.longitude is not None:
            north, east, _ = frame.to_local(setpoint.latitude, setpoint.longitude, 0.0)
        if setpoint.altitude is not None:
            down = self._down(setpoint.altitude, setpoint.frame)
        return north, east, down

    def _down(self, altitude: float, above: int) -> float:
        if above == _F.GLOBAL:
            return self._autopilot.body.frame.altitude - altitude
        if above == _F.GLOBAL_RELATIVE_ALT:
            return self._autopilot.home_position[2] - altitude
        return -altitude  # the ground is level


def _sum(value: float | None, other: float) -> float | None:
    return None if value is None else value + other


def _clamped(axes: Axes, limits: Point) -> Axes:
    x, y, z = (
        None if value is None else min(max(value, -limit), limit)
        for value, limit in zip(axes, limits, strict=True)
    )
    return x, y, z
