"""What the script of a mission item works with.

A script is a generator, as a behaviour's is: what stands before a `yield` is done in one tick, and when it
returns, the item is done. Time is the mission's own (`now`), which stands still while the mission is paused.

    def delay(step: Step) -> Iterator[None]:
        yield from step.wait(step.number(1))
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import isfinite, isnan, radians
from typing import TYPE_CHECKING, TypeAlias

from mavstack.sim.autopilot.mission.places import has_place, place_of

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import Autopilot
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.maneuvers import Maneuvers, Point
    from mavstack.sim.autopilot.mission.runner import MissionRunner

#: Numbers of an item are kept within this.
MOST = 1.0e6


@dataclass(frozen=True, slots=True)
class Step:
    """One item, about to be flown."""

    mission: MissionRunner
    seq: int
    item: MissionItem

    @property
    def autopilot(self) -> Autopilot:
        """Whose mission it is."""
        return self.mission.autopilot

    @property
    def maneuvers(self) -> Maneuvers:
        """How the vehicle is moved."""
        return self.mission.autopilot.maneuvers

    @property
    def now(self) -> float:
        """The mission's time."""
        return self.mission.now

    def number(self, index: int, default: float = 0.0) -> float:
        """A parameter, by its number from 1; what is no number is `default`, what is huge is bounded."""
        value: float = getattr(self.item, f"param{index}")
        return default if isnan(value) else min(max(value, -MOST), MOST)

    def whole(self, index: int, default: int = 0) -> int:
        """A parameter that counts something."""
        return int(self.number(index, default))

    @property
    def has_place(self) -> bool:
        """Whether the item names a place."""
        return has_place(self.item)

    def place(self, *, exact: bool = False) -> Point:
        """Where the item is, in local metres; `exact`: an altitude of 0 is one."""
        here = self.mission.rules.zero_altitude_is_here and not exact
        return place_of(self.autopilot, self.item, zero_is_here=here)

    def yaw(self, index: int = 4) -> float | None:
        """A heading in degrees as radians; None if it is left out."""
        value: float = getattr(self.item, f"param{index}")
        return radians(value % 360.0) if isfinite(value) else None

    def wait(self, seconds: float) -> Iterator[None]:
        """Let time pass."""
        end = self.now + seconds
        while self.now < end:
            self.mission.keep_course()
            yield

    def travel(
        self,
        point: Point,
        *,
        start: Point | None = None,
        yaw: float | None = None,
        radius: float | None = None,
    ) -> Iterator[None]:
        """Fly to a point until it is reached."""
        self.mission.set_course(point, start=start, yaw=yaw)
        while not self.maneuvers.has_reached(point, radius):
            self.mission.keep_course()
            yield

    def behave(self, behaviour: Behaviour) -> Iterator[None]:
        """Do what a mode does, as a part of the mission."""
        self.mission.course.forget()
        self.mission.part = behaviour
        try:
            yield from behaviour.fly()
        finally:
            self.mission.part = None


Script: TypeAlias = Callable[[Step], Iterator[None]]


def nearest(mission: MissionRunner, command: int) -> int | None:
    """The nearest item of a command; one that has no place is as far away as its number."""

    def away(seq: int) -> float:
        step = Step(mission, seq, mission.items[seq])
        return step.maneuvers.distance(step.place()) if step.has_place else float(seq)

    found = (seq for seq, item in enumerate(mission.items) if item.command == command)
    return min(found, key=away, default=None)
