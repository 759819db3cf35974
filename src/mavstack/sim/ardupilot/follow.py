"""ArduPilot's Follow mode: of copters (23), rovers and boats (6), with the parameters FOLL_….

The leader is the system FOLL_SYSID; 0 takes the first one that is heard, and forgets it after 10 s without a
message. GLOBAL_POSITION_INT of any vehicle is enough; once the leader sends FOLLOW_TARGET, only that counts.
Messages without a place (0, 0) and the vehicle's own are ignored. The estimate ends 3 s after the last
message, and beyond FOLL_DIST_MAX; the vehicle stops then without a status text, until it can follow again.

With an offset of 0, 0, 0 the place at the first message is kept as the offset until the mode is left. The
velocity is the leader's and FOLL_POS_P times the error, at most WPNAV_SPEED (rovers: WP_SPEED): a faster
leader is lost without a word. A copter also brakes for its slot while the leader moves, so it stays behind
the slot by the distance from which it could stop: 4 m at 3 m/s. On the ground it stays there.

Source: ArduPilot 4.6, libraries/AP_Follow, ArduCopter/mode_follow.cpp, Rover/mode_follow.cpp.
"""

from __future__ import annotations

from math import atan2, cos, dist, hypot, isfinite, radians, sin, sqrt
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Service
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.leader_report import LeaderReport
from mavstack.sim.parameters.tables import group_definitions
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

#: Seconds after the leader's last message until its position is no longer used, and until the leader is
#: discarded.
ESTIMATE_TIMEOUT: Final = 3.0
FORGET_TIMEOUT: Final = 10.0
#: The status text that ArduCopter sends if FOLL_ENABLE is 0.
DISABLED_TEXT: Final = "Set FOLL_ENABLE = 1"

_ENABLE: Final = "FOLL_ENABLE"
_SYSID: Final = "FOLL_SYSID"
_OFFSETS: Final = ("FOLL_OFS_X", "FOLL_OFS_Y", "FOLL_OFS_Z")
#: Values of FOLL_OFS_TYPE, FOLL_ALT_TYPE and FOLL_YAW_BEHAVE.
_RELATIVE_OFFSET: Final = 1
_RELATIVE_ALTITUDE: Final = 1
_FACE_LEADER: Final = 1
#: Bits of `est_capabilities` of FOLLOW_TARGET.
_HAS_POSITION, _HAS_VELOCITY, _HAS_ATTITUDE = 1, 2, 8
_UNKNOWN_HEADING: Final = 36_000
#: Share of a copter's acceleration that braking uses, gain of its position controller in 1/s, and its
#: vertical acceleration in m/s2.
_BRAKING_SHARE: Final = 0.5
_POSITION_GAIN: Final = 1.0
_CLIMB_ACCELERATION: Final = 1.0
#: Speeds in m/s: a rover stops below the first, a copter turns its nose along its flight above the second.
_ROVER_STOPS_BELOW: Final = 0.03
_TURNS_ABOVE: Final = 1.0
_FACES_BEYOND: Final = 1.0
_FOLLOWERS: Final = frozenset({VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT})


def register_follow(vehicle: SimulatedVehicle) -> None:
    """Receive the leader's messages, and show the parameters of the group when FOLL_ENABLE is set."""
    if vehicle.vehicle_type not in _FOLLOWERS:
        return
    vehicle.autopilot.watches.append(vehicle.engine.add(Leader(vehicle)))
    _show_parameters(vehicle)
    vehicle.parameters.on_change(_ENABLE, lambda _: _show_parameters(vehicle))


def is_enabled(vehicle: SimulatedVehicle) -> bool:
    """Return whether FOLL_ENABLE allows the mode."""
    return bool(vehicle.parameters.get(_ENABLE, 0))


def refuse_entry(vehicle: SimulatedVehicle) -> str:
    """Return the text of the refused mode; a copter sends the reason first."""
    if vehicle.vehicle_type is not VehicleType.COPTER:
        return "Flight mode change failed"
    vehicle.send_statustext(DISABLED_TEXT, common.MavSeverity.WARNING)
    return "Mode change to FOLLOW failed: init failed"


def choose_leader(vehicle: SimulatedVehicle, system: int) -> None:
    """Follow a system from now on; 0: the first one that is heard (DO_FOLLOW)."""
    if _SYSID in vehicle.parameters:
        vehicle.parameters.set(_SYSID, system)


def leader_of(autopilot: SimulatedAutopilot) -> Leader | None:
    """Return the receiver of the leader's messages; None if the vehicle cannot follow."""
    return next((watch for watch in autopilot.watches if isinstance(watch, Leader)), None)


def _show_parameters(vehicle: SimulatedVehicle) -> None:
    parameters = vehicle.parameters
    if not is_enabled(vehicle) or _SYSID in parameters:
        return
    group = "follow" if vehicle.vehicle_type is VehicleType.COPTER else "follow_rover"
    for definition in group_definitions(Firmware.ARDUPILOT, group):
        parameters.table.add(definition)


class Leader(Service):
    """Receives the messages of the leader; one of the autopilot's periodic checks too.

    Args:
        vehicle: The follower.
    """

    handles = message_ids(common.GlobalPositionInt, common.FollowTarget)

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._vehicle = vehicle
        self._report: LeaderReport | None = None
        self._uses_follow_target = False
        self._found_itself = False
        self._offset_was_zero = False

    # Reception

    def receive(self, packet: Packet, now: float) -> bool:
        if not is_enabled(self._vehicle) or packet.system == self._vehicle.address.system:
            return False
        chosen = self._number(_SYSID)
        if chosen not in (0, packet.system):
            return False
        report = self._read(packet, now)
        if report is None:
            return False
        if chosen == 0:
            self._found_itself = True
            self._set(_SYSID, packet.system)
        self._report = report
        return True

    def tick(self, now: float) -> None:
        """Forget a leader that is no longer heard."""
        if self._report is None or now - self._report.received_at < FORGET_TIMEOUT:
            return
        self._report, self._uses_follow_target = None, False
        if self._found_itself:
            self._found_itself = False
            self._set(_SYSID, 0)

    def _read(self, packet: Packet, now: float) -> LeaderReport | None:
        match packet.message:
            case common.GlobalPositionInt(lat=0, lon=0) | common.FollowTarget(lat=0, lon=0):
                return None
            case common.GlobalPositionInt() as message if not self._uses_follow_target:
                return self._position_report(message, now)
            case common.FollowTarget() as message if message.est_capabilities & _HAS_POSITION:
                self._uses_follow_target = True
                return self._target_report(message, now)
        return None

    def _position_report(self, message: common.GlobalPositionInt, now: float) -> LeaderReport:
        autopilot = self._vehicle.autopilot
        north, east, down = autopilot.body.frame.to_local(
            message.lat / 1e7, message.lon / 1e7, message.alt / 1e3
        )
        if self._number("FOLL_ALT_TYPE", _RELATIVE_ALTITUDE) == _RELATIVE_ALTITUDE:
            down = autopilot.home_position[2] - message.relative_alt / 1e3
        known = message.hdg <= _UNKNOWN_HEADING
        last = None if self._report is None else self._report.heading
        heading = radians(message.hdg / 100.0) if known else last
        velocity = (message.vx / 100.0, message.vy / 100.0, message.vz / 100.0)
        return LeaderReport((north, east, down), velocity, heading, now)

    def _target_report(self, message: common.FollowTarget, now: float) -> LeaderReport:
        place = self._vehicle.body.frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt)
        has_velocity = message.est_capabilities & _HAS_VELOCITY
        north, east, down = message.vel if has_velocity else (0.0, 0.0, 0.0)
        heading = None if self._report is None else self._report.heading
        if message.est_capabilities & _HAS_ATTITUDE:
            w, x, y, z = message.attitude_q
            heading = atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        return LeaderReport(place, (north, east, down), heading, now)

    # Guidance

    def slot(self, now: float) -> tuple[LeaderReport, Point, Point] | None:
        """Return the leader, where it is now and where this vehicle should be; None without an estimate."""
        report = self._report
        if report is None or now - report.received_at > ESTIMATE_TIMEOUT:
            return None
        here, place = self._vehicle.autopilot.maneuvers.place, report.position_at(now)
        farthest = self._number("FOLL_DIST_MAX", 100.0)
        if farthest > 0.0 and dist(here, place) > farthest:
            return None
        self._keep_place(report, here, place)
        forward, right, down = (self._number(name) for name in _OFFSETS)
        if self._number("FOLL_OFS_TYPE") == _RELATIVE_OFFSET and report.heading is not None:
            forward, right = _turned(forward, right, report.heading)
        return report, place, (place[0] + forward, place[1] + right, place[2] + down)

    def forget_offset(self) -> None:
        """Return to an offset of zero if the mode began with one."""
        if self._offset_was_zero:
            self._offset_was_zero = False
            for name in _OFFSETS:
                self._set(name, 0.0)

    def _keep_place(self, report: LeaderReport, here: Point, place: Point) -> None:
        """Take the present place as the offset if there is none."""
        if self._offset_was_zero or any(self._number(name) for name in _OFFSETS):
            return
        self._offset_was_zero = True
        north, east, down = (mine - its for mine, its in zip(here, place, strict=True))
        text = "N-E-D follow offset loaded"
        if self._number("FOLL_OFS_TYPE") == _RELATIVE_OFFSET and report.heading is not None:
            north, east = _turned(north, east, -report.heading)
            text = "Relative follow offset loaded"
        else:
            self._set("FOLL_OFS_TYPE", 0)
        for name, value in zip(_OFFSETS, (north, east, down), strict=True):
            self._set(name, value)
        self._vehicle.send_statustext(text, common.MavSeverity.INFO)

    def _number(self, name: str, default: float = 0.0) -> float:
        value = float(self._vehicle.parameters.get(name, default))
        return value if isfinite(value) else default

    def _set(self, name: str, value: float) -> None:
        """Set a parameter as the firmware does here: neither saved nor broadcast."""
        self._vehicle.parameters.table[name].value = value


class Follow(Behaviour):
    """FOLLOW of copters, rovers and boats."""

    def fly(self) -> Iterator[None]:
        """Follow until the mode is left."""
        autopilot, leader = self.autopilot, leader_of(self.autopilot)
        flies = autopilot.vehicle.vehicle_type.flies
        try:
            while leader is not None:
                if flies and autopilot.landed:
                    autopilot.body.idle()
                else:
                    self._steer(leader, copter=flies)
                yield
        finally:
            if leader is not None:
                leader.forget_offset()

    def _steer(self, leader: Leader, *, copter: bool) -> None:
        autopilot = self.autopilot
        found = leader.slot(autopilot.now)
        if found is None:
            autopilot.target = None
            autopilot.body.fly_velocity(0.0, 0.0, 0.0)
            return
        report, place, slot = found
        here = autopilot.maneuvers.place
        gain = float(autopilot.vehicle.parameters.get("FOLL_POS_P", 0.1))
        north, east, down = (
            speed + gain * (goal - mine)
            for speed, goal, mine in zip(report.velocity, slot, here, strict=True)
        )
        autopilot.target = slot
        north, east = _shortened(north, east, autopilot.flight_parameters.cruise_speed)
        if not copter:
            moving = hypot(north, east) >= _ROVER_STOPS_BELOW
            autopilot.body.fly_velocity(north if moving else 0.0, east if moving else 0.0, 0.0)
            return
        away = hypot(slot[0] - here[0], slot[1] - here[1])
        north, east = _shortened(
            north, east, _braking_speed(away, _BRAKING_SHARE * autopilot.body.limits.acceleration)
        )
        fastest = _braking_speed(abs(slot[2] - here[2]), _BRAKING_SHARE * _CLIMB_ACCELERATION)
        flight = autopilot.flight_parameters
        down = min(max(down, -min(fastest, flight.climb_speed)), fastest, flight.sink_speed)
        autopilot.body.fly_velocity(north, east, down, yaw=self._yaw(report, place, (north, east)))

    def _yaw(self, report: LeaderReport, place: Point, velocity: tuple[float, float]) -> float | None:
        here = self.autopilot.maneuvers.place
        north, east = place[0] - here[0], place[1] - here[1]
        match int(self.autopilot.vehicle.parameters.get("FOLL_YAW_BEHAVE", _FACE_LEADER)):
            case 1 if hypot(north, east) > _FACES_BEYOND:
                return atan2(east, north)
            case 2:
                return report.heading
            case 3 if hypot(*velocity) > _TURNS_ABOVE:
                return atan2(velocity[1], velocity[0])
        return None


def _turned(forward: float, right: float, heading: float) -> tuple[float, float]:
    cosine, sine = cos(heading), sin(heading)
    return forward * cosine - right * sine, forward * sine + right * cosine


def _shortened(north: float, east: float, length: float) -> tuple[float, float]:
    share = min(1.0, length / max(hypot(north, east), 1e-9))
    return north * share, east * share


def _braking_speed(distance: float, acceleration: float) -> float:
    """Return the speed from which a vehicle stops within a distance: linear near the end, then a root."""
    linear = acceleration / _POSITION_GAIN**2
    if distance < linear:
        return distance * _POSITION_GAIN
    return sqrt(2.0 * acceleration * (distance - linear / 2.0))
