"""The fence watch: it reports each breach once, reacts once, and reports the end of the breach.

A breach lasts until the vehicle is inside again; a vehicle that flies another `WORSENED_DISTANCE` metres
outwards causes a new one.
"""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import PlanReplaced, PlanType
from mavstack.sim.autopilot.fence.factory import fence_rules_of
from mavstack.sim.autopilot.fence.plan import read_fence
from mavstack.sim.autopilot.fence_limits import Breach, FenceLimits
from mavstack.sim.autopilot.fence_shapes import Fence

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

WORSENED_DISTANCE = 20.0
_KINDS = common.FenceBreach
#: Values of param 1 of DO_FENCE_ENABLE: disable, enable, disable only the minimum altitude.
OFF, ON, FLOOR_OFF = 0, 1, 2


class FenceWatch:
    """The fence of one vehicle; one of its autopilot's watches."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self.autopilot = autopilot
        self.rules = fence_rules_of(autopilot)
        self.breaches = Breach.NONE
        #: The number of breaches since boot, and the time of the last one in seconds since boot.
        self.count = 0
        self.breached_at = 0.0
        #: True if a command enabled the fence, False if a command disabled it; None: the parameters decide.
        self.switched: bool | None = None
        #: True if a command disabled the minimum altitude.
        self.floor_off = False
        self._items: tuple[MissionItem, ...] = ()
        self._fence = Fence()
        self._worst = 0.0
        autopilot.watches.append(self)
        autopilot.vehicle.on_event(PlanReplaced, self._plan_replaced)

    @property
    def fence(self) -> Fence:
        """The shapes of the fence plan."""
        items = self.autopilot.vehicle.plans.get(PlanType.FENCE).items
        if items is not self._items:
            self._items, self._fence = items, read_fence(items, self.autopilot.body.frame)
        return self._fence

    @property
    def limits(self) -> FenceLimits:
        """The limits in force."""
        return self.rules.limits(self)

    @property
    def enabled(self) -> bool:
        """True if any limit is in force."""
        return self.limits.watched != Breach.NONE

    def switch(self, what: int) -> bool:
        """Apply DO_FENCE_ENABLE: 0 off, 1 on, 2 minimum altitude off; returns False for other values."""
        if what not in (OFF, ON, FLOOR_OFF):
            return False
        if what == FLOOR_OFF:
            self.floor_off = True
        else:
            self.switched, self.floor_off = what == ON, False
        if not self.enabled:
            self.breaches = Breach.NONE
            self.autopilot.failsafes.discard("fence")
        return True

    def reset_switch(self) -> None:
        """Go by the parameters again, as after they were set."""
        self.switched, self.floor_off = None, False

    def problems(self) -> Iterator[str]:
        """Yield why the vehicle may not be armed where it is."""
        return self.rules.problems(self)

    def status(self) -> common.FenceStatus:
        """Return FENCE_STATUS."""
        return common.FenceStatus(
            breach_status=int(self.breaches != Breach.NONE),
            breach_count=min(self.count, 0xFFFF),
            breach_type=self._kind(),
            breach_time=int(self.breached_at * 1000) & 0xFFFFFFFF,
        )

    def breach_distance(self) -> float:
        """Return how far the vehicle is beyond its limits, over the ground or in height, in metres."""
        limits, altitude = self.limits, self.autopilot.altitude
        beyond = [0.0]
        if self.breaches & Breach.HIGH:
            beyond.append(altitude - limits.highest)
        if self.breaches & Breach.LOW:
            beyond.append(limits.lowest - altitude)
        if self.breaches & Breach.RADIUS:
            beyond.append(self._from_home() - limits.radius)
        if self.breaches & Breach.SHAPES:
            beyond.append(self.fence.breach_distance(self._place()))
        return max(beyond)

    # Monitoring

    def tick(self, now: float) -> None:
        """Compare the position with the limits."""
        if not self.autopilot.has_position:
            return
        before, self.breaches = self.breaches, self.check()
        new = self.breaches & ~before
        if not self.autopilot.armed:
            return
        if new:
            self.count += 1
            self.breached_at = now - self.autopilot.booted_at
            self._worst = self.breach_distance()
            self.autopilot.failsafes.add("fence")
            self.rules.breached(self, new)
        elif before and not self.breaches:
            self.autopilot.failsafes.discard("fence")
            self.rules.cleared(self)
        elif self.breaches and self.breach_distance() > self._worst + WORSENED_DISTANCE:
            self._worst = self.breach_distance()
            self.count += 1
            self.rules.worsened(self)

    def check(self) -> Breach:
        """Return the limits that are broken at the current position."""
        limits = self.limits
        found = Breach.NONE
        if not limits.watched:
            return found
        altitude = self.autopilot.altitude
        if altitude >= limits.highest - limits.margin:
            found |= Breach.HIGH
        if altitude <= limits.lowest + limits.margin and not self.autopilot.landed:
            found |= Breach.LOW
        if self._from_home() >= limits.radius - limits.margin:
            found |= Breach.RADIUS
        if self.fence.shapes and not self._permitted(limits):
            found |= Breach.SHAPES
        return found & limits.watched

    def _permitted(self, limits: FenceLimits) -> bool:
        place = self._place()
        if limits.margin > 0 and self.fence.edge_distance(place) < limits.margin:
            return False
        return self.fence.permits(place, union=limits.union)

    def _place(self) -> tuple[float, float]:
        return self.autopilot.maneuvers.place[:2]

    def _from_home(self) -> float:
        north, east, _ = self.autopilot.home_position
        return hypot(self._place()[0] - north, self._place()[1] - east)

    def _kind(self) -> int:
        if self.breaches & (Breach.SHAPES | Breach.RADIUS):
            return _KINDS.BOUNDARY
        if self.breaches & Breach.HIGH:
            return _KINDS.MAXALT
        return _KINDS.MINALT if self.breaches & Breach.LOW else _KINDS.NONE

    def _plan_replaced(self, event: PlanReplaced) -> None:
        if event.plan.type == PlanType.FENCE:
            self.rules.replaced(self)
