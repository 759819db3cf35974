"""PX4's Follow Target mode (main 4, sub 8): of multicopters, with the parameters FLW_TGT_….

Only FOLLOW_TARGET counts, of any system, and in it the place, the altitude and the velocity. The target's
course is the direction of its velocity, while it moves; before it has moved, the vehicle keeps its side of
the target. The place of the vehicle is FLW_TGT_DST metres from the target, at FLW_TGT_FA degrees clockwise
from its course, and moves around the target with at most FLW_TGT_MAX_VEL. The height is FLW_TGT_HT above
home, or above the target with FLW_TGT_ALT_M 2; a vehicle more than 3 m from it climbs or sinks before it
moves over ground. Three seconds after the last message the vehicle stays where it is, without a status text.
Targets faster than MPC_XY_VEL_MAX are lost without one too. Below 1 m it climbs slowly and does not move over
ground.

Source: PX4 1.17, flight_mode_manager/tasks/AutoFollowTarget, msg/FollowTarget.
"""

from __future__ import annotations

from math import atan2, copysign, cos, hypot, inf, isfinite, radians, remainder, sin, tau
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Service
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.leader_report import LeaderReport
from mavstack.sim.autopilot.ticks import TICK
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

#: Seconds after which the target's last message is no longer used.
TARGET_TIMEOUT: Final = 3.0
#: Speed of the target in m/s above which its velocity defines its course.
_MOVES_ABOVE: Final = 0.1
#: Height error in metres above which the vehicle only climbs or descends.
_HEIGHT_ACCEPTANCE: Final = 3.0
#: Below this height above home, in metres, the vehicle only climbs, at the given speed in m/s.
_SAFETY_HEIGHT: Final = 1.0
_SAFETY_CLIMB: Final = 0.2
_MIN_HEIGHT: Final = 8.0
_MIN_DISTANCE: Final = 1.0
#: Value of FLW_TGT_ALT_M: the height is above the target.
_ABOVE_TARGET: Final = 2
#: Time constant in seconds, for each unit of FLW_TGT_RS, with which the vehicle follows a turn of the target.
_RESPONSE_TIME: Final = 3.0
#: Gain of the position error in 1/s, close to the defaults of MPC_XY_P and MPC_Z_P.
_GAIN: Final = 0.95


def register_follow(vehicle: SimulatedVehicle) -> None:
    """Receive FOLLOW_TARGET."""
    if vehicle.vehicle_type is VehicleType.COPTER:
        vehicle.autopilot.watches.append(vehicle.engine.add(Target(vehicle)))


class Target(Service):
    """Receives the messages of the target; among the autopilot's periodic checks it only is found.

    Args:
        vehicle: The follower.
    """

    handles = message_ids(common.FollowTarget)

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._frame = vehicle.body.frame
        self._report: LeaderReport | None = None

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.FollowTarget() as message if message.lat or message.lon:
                north, east, down = message.vel
                known = all(map(isfinite, (north, east, down, message.alt)))
                if known:
                    place = self._frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt)
                    self._report = LeaderReport(place, (north, east, down), None, now)
        return False

    def tick(self, now: float) -> None:
        """Forget a target that is no longer heard."""
        if self._report is not None and now - self._report.received_at > TARGET_TIMEOUT:
            self._report = None

    @property
    def report(self) -> LeaderReport | None:
        """The target's last message; None if it is too old."""
        return self._report


class FollowTarget(Behaviour):
    """Follow Target."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        super().__init__(autopilot)
        #: Direction from the target to the vehicle, in radians; None before the first message.
        self._angle: float | None = None

    def fly(self) -> Iterator[None]:
        """Follow until the mode is left."""
        autopilot = self.autopilot
        target = next((watch for watch in autopilot.watches if isinstance(watch, Target)), None)
        waiting = False
        while True:
            report = None if target is None else target.report
            if report is None:
                if not waiting:
                    autopilot.maneuvers.hold()
                waiting = True
            else:
                waiting = False
                self._steer(report)
            yield

    def _steer(self, report: LeaderReport) -> None:
        autopilot = self.autopilot
        here, target = autopilot.maneuvers.place, report.position_at(autopilot.now)
        down = self._down(target, autopilot.home_position[2])
        yaw = atan2(target[1] - here[1], target[0] - here[0])
        if autopilot.altitude < _SAFETY_HEIGHT:
            autopilot.body.fly_velocity(0.0, 0.0, -_SAFETY_CLIMB, yaw=yaw)
            return
        turning = self._turn(report, here, target)
        distance, angle = self._distance, self._angle or 0.0
        slot = (target[0] + distance * cos(angle), target[1] + distance * sin(angle), down)
        autopilot.target = slot
        flight = autopilot.flight_parameters
        climb = min(max(_GAIN * (down - here[2]), -flight.climb_speed), flight.sink_speed)
        if abs(down - here[2]) > _HEIGHT_ACCEPTANCE:
            autopilot.body.fly_velocity(0.0, 0.0, climb, yaw=yaw)
            return
        across = turning * distance
        north = report.velocity[0] - across * sin(angle) + _GAIN * (slot[0] - here[0])
        east = report.velocity[1] + across * cos(angle) + _GAIN * (slot[1] - here[1])
        share = min(1.0, self._number("MPC_XY_VEL_MAX", 12.0) / max(hypot(north, east), 1e-9))
        autopilot.body.fly_velocity(north * share, east * share, climb, yaw=yaw)

    def _turn(self, report: LeaderReport, here: Point, target: Point) -> float:
        """Turn around the target; return the rate in rad/s."""
        if self._angle is None:
            self._angle = atan2(here[1] - target[1], here[0] - target[0])
        north, east, _ = report.velocity
        if hypot(north, east) <= _MOVES_ABOVE:
            return 0.0
        wanted = atan2(east, north) + radians(self._number("FLW_TGT_FA", 180.0))
        error = remainder(wanted - self._angle, tau)
        seconds = max(_RESPONSE_TIME * self._number("FLW_TGT_RS", 0.1), TICK)
        fastest = self._number("FLW_TGT_MAX_VEL", 5.0) / self._distance
        rate = copysign(min(abs(error) / seconds, fastest), error)
        self._angle += rate * TICK
        return rate

    def _down(self, target: Point, home: float) -> float:
        height = max(self._number("FLW_TGT_HT", _MIN_HEIGHT), _MIN_HEIGHT)
        above_target = int(self._number("FLW_TGT_ALT_M", 0.0)) == _ABOVE_TARGET
        return (target[2] if above_target else home) - height

    @property
    def _distance(self) -> float:
        return max(self._number("FLW_TGT_DST", _MIN_HEIGHT), _MIN_DISTANCE)

    def _number(self, name: str, default: float) -> float:
        value = float(self.autopilot.vehicle.parameters.get(name, default))
        return value if -inf < value < inf else default
