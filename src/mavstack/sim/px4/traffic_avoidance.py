"""PX4's traffic avoidance: NAV_TRAFF_AVOID 1 warns, 2 returns, 3 lands, 4 holds.

An aircraft conflicts if its course leads past the vehicle within NAV_TRAFF_A_HOR metres, its altitude differs
by less than NAV_TRAFF_A_VER, and the two could meet within NAV_TRAFF_COLL_T seconds at the sum of their
speeds. A conflict is reported when it begins, and again after a minute. A real PX4 sends events; these are
status texts. Source: PX4, lib/adsb and modules/navigator.
"""

from __future__ import annotations

from math import atan2, degrees, hypot
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.traffic import TrafficReceiver, gap
from mavstack.sim.px4 import modes

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.traffic import Contact

#: Seconds after which a conflict that persists is reported again.
REMINDER: Final = 60.0
#: The course of an aircraft is predicted up to this many metres beyond the vehicle.
_BEYOND: Final = 1000.0
_ACTIONS: Final = {
    2: (modes.RETURN, ", returning home"), 3: (modes.LAND, ", landing"),
    4: (modes.HOLD, ", holding position"),
}  # fmt: skip
_RESTING: Final = 1e-3


class TrafficAvoidance:
    """The avoidance of one vehicle; runs on each tick."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._traffic = autopilot.vehicle.engine.add(TrafficReceiver(autopilot.vehicle))
        self._conflicts: dict[int, float] = {}
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Look for conflicts in flight."""
        autopilot = self._autopilot
        mode = int(self._number("NAV_TRAFF_AVOID", 1))
        if not mode or not autopilot.armed or autopilot.landed:
            return
        for contact in self._traffic.contacts(now):
            aside = self._miss(contact.moved(now))
            if aside is None:
                if self._conflicts.pop(contact.address, None) is not None:
                    self._report(f"Traffic Conflict Resolved {contact.address}!")
            elif now - self._conflicts.get(contact.address, float("-inf")) > REMINDER:
                self._conflicts[contact.address] = now
                self._act(contact, aside, mode)

    def _miss(self, contact: Contact) -> float | None:
        """Return the metres at which an aircraft passes; None without a conflict."""
        here = self._autopilot.body.estimate
        distance = gap(contact, here[:3])
        speed = hypot(contact.velocity_north, contact.velocity_east)
        own = hypot(here.velocity_north, here.velocity_east, here.velocity_down)
        closing = hypot(speed, contact.velocity_down) + own
        apart = abs(contact.down - here.down)
        if closing < _RESTING or hypot(distance, apart) / closing >= self._number("NAV_TRAFF_COLL_T", 60):
            return None
        if apart >= self._number("NAV_TRAFF_A_VER", 500) or speed < _RESTING:
            return None
        north, east = here.north - contact.north, here.east - contact.east
        along = (north * contact.velocity_north + east * contact.velocity_east) / speed
        aside = abs(north * contact.velocity_east - east * contact.velocity_north) / speed
        ahead = 0 <= along <= distance + _BEYOND
        return aside if ahead and aside < self._number("NAV_TRAFF_A_HOR", 500) else None

    def _act(self, contact: Contact, aside: float, mode: int) -> None:
        heading = round(degrees(atan2(contact.velocity_east, contact.velocity_north)))
        number, words = _ACTIONS.get(mode, (None, ""))
        self._report(
            f"Traffic alert - ICAO Address {contact.address}! Separation Distance {aside:.0f}, "
            f"Heading {heading}{words}"
        )
        if number is not None and self._autopilot.mode.number != number:
            self._autopilot.enter(number, "traffic")

    def _report(self, text: str) -> None:
        self._autopilot.vehicle.send_statustext(text, common.MavSeverity.NOTICE)

    def _number(self, name: str, default: float) -> float:
        return float(self._autopilot.vehicle.parameters.get(name, default))
