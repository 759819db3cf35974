"""ArduPilot's avoidance of aircraft: AVD_ENABLE, and the parameters behind it.

The most serious threat is reported once a second as COLLISION. A high one (AVD_F_…) leads to AVD_F_ACTION:
climb or descend, move horizontally, fly away at a right angle, return, or hover; for the first three a copter
enters AVOID_ADSB. Two seconds after the last high threat AVD_F_RCVRY decides how the flight continues.
Source: ArduPilot, AP_Avoidance.
"""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.autopilot.traffic import TrafficReceiver, gap

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.traffic import Contact

_ACTION, _THREAT = common.MavCollisionAction, common.MavCollisionThreatLevel
_COPTER = ardupilotmega.CopterMode
#: In seconds: the interval of the reports, and the time until a lower threat level is accepted.
INTERVAL: Final = 1.0
RECOVERY_TIME: Final = 2.0
#: Defaults of a copter: times in seconds, horizontal (XY) and vertical (Z) distances in metres.
_DEFAULTS: Final = {
    "AVD_W_TIME": 30.0, "AVD_W_DIST_XY": 300.0, "AVD_W_DIST_Z": 300.0,
    "AVD_F_TIME": 30.0, "AVD_F_DIST_XY": 100.0, "AVD_F_DIST_Z": 100.0,
    "AVD_F_ACTION": 1.0, "AVD_F_RCVRY": 2.0, "AVD_F_ALT_MIN": 0.0,
}  # fmt: skip
#: Values of AVD_F_RCVRY: 0 stays in the mode, 1 enters the mode before the avoidance, 2 enters RTL, others
#: enter AUTO if it was active before, else LOITER.
_STAY, _RESUME, _RETURN = 0, 1, 2
_RESTING: Final = 0.1


class Threat(NamedTuple):
    """An aircraft as a threat: level, and its closest approach in seconds and metres."""

    level: int
    time: float
    horizontal: float
    vertical: float
    contact: Contact


class TrafficAvoidance:
    """The avoidance of one copter; runs on each tick."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._traffic = autopilot.vehicle.engine.add(TrafficReceiver(autopilot.vehicle))
        self._reported_at = self._changed_at = float("-inf")
        self._level = int(_THREAT.NONE)
        self._mode_before: int | None = None
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Assess the threats, act, and report."""
        if not self._number("AVD_ENABLE", 0) or not self._autopilot.has_position:
            return
        threats = [self._assess(contact, now) for contact in self._traffic.contacts(now)]
        worst = max(threats, key=lambda threat: (threat.level, -threat.time), default=None)
        level = int(_THREAT.NONE) if worst is None else worst.level
        self._change(level, now)
        if worst is None or worst.level == _THREAT.NONE:
            return
        action = self._action() if self._level == _THREAT.HIGH else int(_ACTION.REPORT)
        if self._level == _THREAT.HIGH and action > _ACTION.REPORT:
            self._avoid(worst.contact.moved(now), action)
        if now - self._reported_at >= INTERVAL:
            self._reported_at = now
            self._autopilot.vehicle.services.send(_collision(worst, action))

    def _assess(self, contact: Contact, now: float) -> Threat:
        """Return the threat of an aircraft, for the horizons of warnings and of failures."""
        age = now - contact.at
        level, horizontal, vertical = int(_THREAT.NONE), *self._approach(contact, "AVD_W_TIME", age)
        if horizontal < self._number("AVD_W_DIST_XY") and vertical <= self._number("AVD_W_DIST_Z"):
            level = int(_THREAT.LOW)
        near, low = self._approach(contact, "AVD_F_TIME", age)
        if level and near < self._number("AVD_F_DIST_XY") and low <= self._number("AVD_F_DIST_Z"):
            level, horizontal, vertical = int(_THREAT.HIGH), near, low
        here = self._autopilot.body.estimate
        speed = hypot(
            contact.velocity_north - here.velocity_north, contact.velocity_east - here.velocity_east
        )
        distance = gap(contact.moved(now), self._autopilot.maneuvers.place) - horizontal
        return Threat(level, distance / speed if speed > _RESTING else 0.0, horizontal, vertical, contact)

    def _approach(self, contact: Contact, horizon: str, age: float) -> tuple[float, float]:
        """Return how close an aircraft comes within a time, over the ground and in height."""
        seconds, here = self._number(horizon) + age, self._autopilot.body.estimate
        north, east = contact.north - here.north, contact.east - here.east
        vn = contact.velocity_north - here.velocity_north
        ve = contact.velocity_east - here.velocity_east
        squared = vn * vn + ve * ve
        at = min(max(-(north * vn + east * ve) / squared, 0.0), seconds) if squared > _RESTING**2 else 0.0
        down = contact.down - here.down
        sinking = contact.velocity_down - here.velocity_down
        vertical = abs(down) if down * sinking >= 0 else abs(down + sinking * seconds)
        return hypot(north + vn * at, east + ve * at), vertical

    def _change(self, level: int, now: float) -> None:
        """Follow a higher level at once, a lower one after some time."""
        if level == self._level or (level < self._level and now - self._changed_at <= RECOVERY_TIME):
            return
        if self._level == _THREAT.HIGH:
            self._recover()
        self._level, self._changed_at = level, now

    def _action(self) -> int:
        action, lowest = int(self._number("AVD_F_ACTION")), self._number("AVD_F_ALT_MIN")
        if action > _ACTION.REPORT and lowest > 0 and self._autopilot.altitude < lowest:
            return int(_ACTION.REPORT)
        return action

    def _avoid(self, contact: Contact, action: int) -> None:
        autopilot = self._autopilot
        if not autopilot.armed or autopilot.landed:
            return
        mode = {int(_ACTION.RTL): _COPTER.RTL, int(_ACTION.HOVER): _COPTER.LOITER}.get(
            action, _COPTER.AVOID_ADSB
        )
        if self._mode_before is None:
            self._mode_before = autopilot.mode.number
            autopilot.enter(int(mode), "AVOIDANCE")
        if mode == _COPTER.AVOID_ADSB and autopilot.mode.number == mode:
            autopilot.guided.fly_velocity(*self._away(contact, action))

    def _away(self, contact: Contact, action: int) -> tuple[float, float, float]:
        """Return the velocity away from an aircraft, at a right angle to its course."""
        here, limits = self._autopilot.body.estimate, self._autopilot.body.limits
        north, east, down = here.north - contact.north, here.east - contact.east, here.down - contact.down
        squared = contact.velocity_north**2 + contact.velocity_east**2
        along = (north * contact.velocity_north + east * contact.velocity_east) / max(squared, 1.0)
        north, east = north - along * contact.velocity_north, east - along * contact.velocity_east
        # On a head-on course: move to the right, seen from the vehicle towards the aircraft.
        if hypot(north, east) < _RESTING:
            north, east = contact.velocity_east, -contact.velocity_north
        length = max(hypot(north, east), _RESTING)
        sideways = limits.speed * north / length, limits.speed * east / length
        vertical = limits.sink if down > 0 else -limits.climb
        if action == _ACTION.ASCEND_OR_DESCEND:
            return 0.0, 0.0, vertical
        return *sideways, 0.0 if action == _ACTION.MOVE_HORIZONTALLY else vertical

    def _recover(self) -> None:
        """Continue as AVD_F_RCVRY says, unless a person has changed the mode meanwhile."""
        autopilot, before, self._mode_before = self._autopilot, self._mode_before, None
        if before is None or autopilot.mode_reason != "AVOIDANCE":
            return
        choice = int(self._number("AVD_F_RCVRY"))
        if choice == _STAY:
            return
        again = before if choice == _RESUME or before == _COPTER.AUTO else int(_COPTER.LOITER)
        autopilot.enter(int(_COPTER.RTL) if choice == _RETURN else again, "AVOIDANCE_RECOVERY")

    def _number(self, name: str, default: float | None = None) -> float:
        return float(
            self._autopilot.vehicle.parameters.get(name, _DEFAULTS[name] if default is None else default)
        )


def _collision(threat: Threat, action: int) -> common.Collision:
    return common.Collision(
        src=common.MavCollisionSrc.ADSB,
        id=threat.contact.address,
        action=action,
        threat_level=threat.level,
        time_to_minimum_delta=threat.time,
        altitude_minimum_delta=threat.vertical,
        horizontal_minimum_delta=threat.horizontal,
    )
