"""Watches the fence: what is broken is told and acted on once, and told again when it is whole again.

What is beyond a fence stays so until the vehicle is inside again; only if it goes on outwards for another
`FARTHER` metres it is a breach anew.
"""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import PlanReplaced, PlanType
from mavstack.sim.autopilot.fence.factory import fence_rules_of
from mavstack.sim.autopilot.fence.geometry import Fence
from mavstack.sim.autopilot.fence.limits import Breach, FenceLimits
from mavstack.sim.autopilot.fence.plan import read_fence

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.interfaces import Autopilot

FARTHER = 20.0
_KINDS = common.FenceBreach
#: DO_FENCE_ENABLE.
OFF, ON, FLOOR_OFF = 0, 1, 2


class FenceWatch:
    """The fence of one vehicle; one of its autopilot's watches."""

    def __init__(self, autopilot: Autopilot) -> None:
        self.autopilot = autopilot
        self.rules = fence_rules_of(autopilot)
        self.breaches = Breach.NONE
        #: How often a limit was broken, and when last, in seconds since the start.
        self.count = 0
        self.breached_at = 0.0
        #: Whether a command switched the fence on or off; None: as the parameters say.
        self.switched: bool | None = None
        #: Whether a command switched the lowest altitude off.
        self.floor_off = False
        self._items: tuple[MissionItem, ...] = ()
        self._fence = Fence()
        self._worst = 0.0
        autopilot.watches.append(self)
        autopilot.vehicle.on_event(PlanReplaced, self._plan_replaced)

    @property
    def fence(self) -> Fence:
        """The shapes of the plan."""
        items = self.autopilot.vehicle.plans.get(PlanType.FENCE).items
        if items is not self._items:
            self._items, self._fence = items, read_fence(items, self.autopilot.body.frame)
        return self._fence

    @property
    def limits(self) -> FenceLimits:
        """What counts just now."""
        return self.rules.limits(self)

    @property
    def enabled(self) -> bool:
        """Whether anything is watched."""
        return self.limits.watched != Breach.NONE

    def switch(self, what: int) -> bool:
        """DO_FENCE_ENABLE: 0 off, 1 on, 2 the lowest altitude off; False if it is none of these."""
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

    def forget_switch(self) -> None:
        """Go by the parameters again, as after they were set."""
        self.switched, self.floor_off = None, False

    def problems(self) -> Iterator[str]:
        """Why the vehicle may not be armed where it stands."""
        return self.rules.problems(self)

    def status(self) -> common.FenceStatus:
        """FENCE_STATUS."""
        return common.FenceStatus(
            breach_status=int(self.breaches != Breach.NONE),
            breach_count=min(self.count, 0xFFFF),
            breach_type=self._kind(),
            breach_time=int(self.breached_at * 1000) & 0xFFFFFFFF,
        )

    def breach_distance(self) -> float:
        """How far the vehicle is beyond what it should not be beyond, over the ground or in height."""
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

    # Watching

    def tick(self, now: float) -> None:
        """Compare where the vehicle is with where it may be."""
        if not self.autopilot.has_position:
            return
        before, self.breaches = self.breaches, self.look()
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
        elif self.breaches and self.breach_distance() > self._worst + FARTHER:
            self._worst = self.breach_distance()
            self.count += 1
            self.rules.worsened(self)

    def look(self) -> Breach:
        """What is broken where the vehicle is."""
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
