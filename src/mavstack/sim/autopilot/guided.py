"""Guided flight: the target that commands and setpoints give, as `autopilot.guided`.

Setpoints come in many frames. They are converted into guided commands in local metres at the moment of
reception, since some are relative to the current position or heading. The behaviour of the mode decides
whether they are followed (`takes_setpoints`). A stream is monitored in any mode, because PX4 enters its
offboard mode only when there is a stream.
"""

from __future__ import annotations

from math import cos, inf, sin
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint, SetpointReceived
from mavstack.sim.autopilot.behaviours.guided_commands import Attitude, Axes, GoTo, GuidedCommand, Motion
from mavstack.sim.autopilot.behaviours.orbit import Orbit
from mavstack.sim.autopilot.behaviours.takeoff import Takeoff

if TYPE_CHECKING:
    from mavstack.services.setpoints import Setpoint
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.maneuvers import Point

_F = common.MavFrame
NOTHING: Axes = (None, None, None)
#: Frames whose axes turn with the vehicle (forward, right), and frames whose positions are relative to the
#: vehicle.
_TURNED = frozenset({_F.BODY_NED, _F.BODY_OFFSET_NED, _F.BODY_FRD, _F.LOCAL_FRD})
_FROM_HERE = frozenset({_F.LOCAL_OFFSET_NED, _F.BODY_NED, _F.BODY_OFFSET_NED, _F.BODY_FRD})
#: Maximum of a setpoint: horizontal distance in metres, altitude in metres, velocity and acceleration (m/s,
#: m/s2).
_FAR, _HIGH, _FAST = 2.0e6, 1.0e5, 100.0


class GuidedFlight:
    """The active guided command of one vehicle."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self.command: Behaviour | None = None
        self._stream_command: GuidedCommand | None = None
        self._received_at = -inf
        autopilot.vehicle.on_event(SetpointReceived, self._received)

    # Commands

    def clear(self) -> None:
        """Drop the active guided command."""
        self.command = None

    def go_to(
        self,
        point: Point,
        *,
        speed: float | None = None,
        radius: float | None = None,
        yaw: float | None = None,
    ) -> None:
        """Go to a point and stay there; a wing circles it with `radius`, negative for counter-clockwise."""
        self._follow_command(GoTo(self._autopilot, point, speed=speed, radius=radius, yaw=yaw))

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
        command = Motion(self._autopilot, NOTHING, (north, east, down), NOTHING, yaw=yaw, yaw_rate=yaw_rate)
        self._follow_command(command)

    def orbit(
        self,
        centre: Point,
        radius: float,
        *,
        speed: float | None = None,
        yaw_behaviour: int = common.OrbitYawBehaviour.HOLD_FRONT_TO_CIRCLE_CENTER,
        turns: float | None = None,
    ) -> None:
        """Circle a point; a positive radius means clockwise."""
        self.command = Orbit(
            self._autopilot, centre, radius, speed=speed, yaw_behaviour=yaw_behaviour, turns=turns
        )

    def take_off(
        self, altitude: float | None = None, *, down: float | None = None, yaw: float | None = None
    ) -> None:
        """Take off and stay above the place of the start."""
        self.command = Takeoff(self._autopilot, altitude, down=down, yaw=yaw)

    # Setpoints

    @property
    def stream_alive(self) -> bool:
        """True while the newest setpoint is recent, and the estimate that it needs is there.

        One setpoint is enough: PX4 checks the age of the newest one against COM_OF_LOSS_T, ten times a second
        and after each change of its state (here whenever it is asked), not how many came before.
        """
        age = self._autopilot.vehicle.now - self._received_at
        needs_position = not isinstance(self._stream_command, Attitude)
        has_estimate = self._autopilot.has_position or not needs_position
        return has_estimate and age < self._autopilot.flight_parameters.setpoint_timeout

    def follow_stream(self) -> None:
        """Follow the latest setpoint of the stream."""
        self.command = self._stream_command if self.stream_alive else None

    def _received(self, event: SetpointReceived) -> None:
        self.set(event.setpoint)

    def set(self, setpoint: Setpoint) -> bool:
        """Accept a setpoint; returns False if this vehicle cannot follow it."""
        command = self._read(setpoint)
        if command is None:
            return False
        self._received_at = self._autopilot.vehicle.now
        if self._stream_command is None or not self._stream_command.renew(command):
            self._stream_command = command
        behaviour = self._autopilot.behaviour
        if behaviour is not None and behaviour.takes_setpoints:
            self._follow_command(self._stream_command)
        return True

    def _follow_command(self, command: GuidedCommand) -> None:
        if not (
            isinstance(self.command, GuidedCommand)
            and (self.command is command or self.command.renew(command))
        ):
            self.command = command

    def _read(self, setpoint: Setpoint) -> GuidedCommand | None:
        match setpoint:
            case AttitudeSetpoint():
                return Attitude(self._autopilot, setpoint)
            case _ if not self._autopilot.flight_parameters.follows_positions:
                return self._altitude_change(setpoint)
            case GlobalSetpoint():
                return self._motion(setpoint, self._global_position(setpoint), setpoint.velocity)
            case LocalSetpoint() if setpoint.frame in self._autopilot.flight_parameters.setpoint_frames:
                position = self._local_position(setpoint)
                return self._motion(setpoint, position, self._turned(setpoint, setpoint.velocity))
        return None

    def _altitude_change(self, setpoint: LocalSetpoint | GlobalSetpoint) -> GuidedCommand | None:
        """Return a change of altitude around the present target; None for other setpoints."""
        here = self._autopilot.target or self._autopilot.maneuvers.place
        if isinstance(setpoint, GlobalSetpoint):
            down = None if setpoint.altitude is None else self._down(setpoint.altitude, setpoint.frame)
        else:
            change = setpoint.position[2] if setpoint.frame == _F.LOCAL_OFFSET_NED else None
            down = _sum(change, here[2])
        return None if down is None else GoTo(self._autopilot, (here[0], here[1], down))

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
        drives = autopilot.vehicle.vehicle_type.on_surface and setpoint.frame in _TURNED
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
        """Rotate vehicle axes into ground axes; forward and right belong together."""
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
        return -altitude  # the ground is level, so altitudes above the terrain count from the local origin


def _sum(value: float | None, other: float) -> float | None:
    return None if value is None else value + other


def _clamped(axes: Axes, limits: Point) -> Axes:
    x, y, z = (
        None if value is None else min(max(value, -limit), limit)
        for value, limit in zip(axes, limits, strict=True)
    )
    return x, y, z
