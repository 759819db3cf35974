"""ArduPilot's avoidance of aircraft: AVD_ENABLE, and the parameters behind it.

The most serious threat is reported once a second as COLLISION. A high one (AVD_F_…) leads to AVD_F_ACTION,
which copters and planes do in their own ways (`traffic_evasion`). Two seconds after the last high threat
AVD_F_RCVRY decides how the flight continues. Source: ArduPilot, AP_Avoidance.
"""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects import common
from mavstack.sim.autopilot.traffic import TrafficReceiver, gap

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.traffic_evasion import CopterEvasion, PlaneEvasion
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.traffic import Contact

_ACTION, _THREAT = common.MavCollisionAction, common.MavCollisionThreatLevel
#: In seconds: the interval of the reports, and the time until a lower threat level is accepted.
INTERVAL: Final = 1.0
RECOVERY_TIME: Final = 2.0
_RESTING: Final = 0.1


class Threat(NamedTuple):
    """An aircraft as a threat: level, and its closest approach in seconds and metres."""

    level: int
    time: float
    horizontal: float
    vertical: float
    contact: Contact


class TrafficAvoidance:
    """The avoidance of one copter or plane; runs on each tick."""

    def __init__(self, autopilot: SimulatedAutopilot, evasion: CopterEvasion | PlaneEvasion) -> None:
        self._autopilot, self._evasion = autopilot, evasion
        self._traffic = autopilot.vehicle.engine.add(TrafficReceiver(autopilot.vehicle))
        self._reported_at = self._changed_at = float("-inf")
        self._level = int(_THREAT.NONE)
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
            action = self._evasion.avoid(worst.contact.moved(now), action)
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
            self._evasion.recover(int(self._number("AVD_F_RCVRY")))
        self._level, self._changed_at = level, now

    def _action(self) -> int:
        action, lowest = int(self._number("AVD_F_ACTION")), self._number("AVD_F_ALT_MIN")
        here, frame = self._autopilot.maneuvers.place, self._autopilot.body.frame
        # The lowest altitude is above the sea, not above home.
        if action > _ACTION.REPORT and lowest > 0 and frame.to_global(*here)[2] < lowest:
            return int(_ACTION.REPORT)
        return action

    def _number(self, name: str, default: float | None = None) -> float:
        usual = self._evasion.DEFAULTS[name] if default is None else default
        return float(self._autopilot.vehicle.parameters.get(name, usual))


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
