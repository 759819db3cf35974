"""A mission as the scripts of its items and the rules of a firmware see it, and the step of one item.

A script is a generator, as a behaviour is: the code before a `yield` runs in one tick, and when the generator
returns, the item is complete. Time is mission time (`now`), which stops while the mission is paused.

    def delay(step: Step) -> Iterator[None]:
        yield from step.wait(step.number(1))

The runner and the scripts are shared by all firmwares; `MissionRules` hold the differences.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import isfinite, isnan, radians
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.sim.autopilot.item_positions import has_place, place_of

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.maneuvers import Maneuvers, Point
    from mavstack.sim.autopilot.mission.runner import MissionRunner

_RESULT = common.MavMissionResult
#: Values of an item's params are limited to this magnitude.
MAX_NUMBER = 1.0e6


@dataclass(frozen=True, slots=True)
class Step:
    """One item in progress: the argument of its script."""

    mission: MissionRunner
    seq: int
    item: MissionItem

    @property
    def autopilot(self) -> SimulatedAutopilot:
        """The autopilot that flies the mission."""
        return self.mission.autopilot

    @property
    def maneuvers(self) -> Maneuvers:
        """The maneuvers of the vehicle."""
        return self.mission.autopilot.maneuvers

    @property
    def now(self) -> float:
        """Mission time, in seconds."""
        return self.mission.now

    def number(self, index: int, default: float = 0.0) -> float:
        """Return a param by its number from 1, clipped; `default` for NaN."""
        value: float = getattr(self.item, f"param{index}")
        return default if isnan(value) else min(max(value, -MAX_NUMBER), MAX_NUMBER)

    def whole(self, index: int, default: int = 0) -> int:
        """Return a param as an integer."""
        return int(self.number(index, default))

    @property
    def has_place(self) -> bool:
        """True if the item has a latitude and a longitude."""
        return has_place(self.item)

    def place(self, *, exact: bool = False) -> Point:
        """Return the position of the item in local metres; `exact`: an altitude of 0 means 0."""
        here = self.mission.rules.zero_altitude_is_here and not exact
        return place_of(self.autopilot, self.item, zero_is_here=here)

    def yaw(self, index: int = 4) -> float | None:
        """Return a heading in radians; None if the param is NaN."""
        value: float = getattr(self.item, f"param{index}")
        return radians(value % 360.0) if isfinite(value) else None

    def wait(self, seconds: float) -> Iterator[None]:
        """Wait for some seconds of mission time."""
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
        while not self.maneuvers.has_reached(self._followed(point), radius):
            self.mission.keep_course()
            yield

    def _followed(self, point: Point) -> Point:
        """Return the end of the line, at the height that the terrain demands now."""
        down = self.mission.course.followed_down
        return point if down is None else (*point[:2], down)

    def behave(self, behaviour: Behaviour) -> Iterator[None]:
        """Run the behaviour of a mode as a part of the mission."""
        self.mission.course.clear()
        self.mission.part = behaviour
        try:
            yield from behaviour.fly()
        finally:
            self.mission.part = None


Script: TypeAlias = Callable[[Step], Iterator[None]]


class MissionRules(ABC):
    """The mission rules of one firmware on one vehicle."""

    #: The sequence number of the first item that is flown.
    first: int
    #: True if DO and CONDITION items run in parallel with the next NAV item, False if they run before it.
    actions_meanwhile: bool
    #: True if an altitude of 0 in a frame above home means the current altitude.
    zero_altitude_is_here: bool
    #: True if a VTOL flies waypoints in forward flight unless commanded to hover.
    waypoints_fly_forward: bool
    #: True if NAV_RETURN_TO_LAUNCH enters the return mode, False if the mission flies home in its own mode.
    returns_in_mode = True
    #: True if a landing item of a plane ends only when the plane disarms.
    wing_stays_landed = False
    #: True if the vehicle flies to the position of a takeoff item after the climb.
    takeoff_flies_to_position = False
    #: True if waypoints have a hold time (param 1).
    hold_counts = True
    #: True if param 4 of an item sets the heading.
    yaw_counts = False
    #: True if param 3 of a waypoint is the distance at which the vehicle may pass it.
    passes_by = False
    #: True if param 2 of a waypoint is its acceptance radius.
    radius_counts = True

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self.autopilot = autopilot
        self.vehicle = autopilot.vehicle

    @property
    def grounded(self) -> bool:
        """True if the vehicle can fly and is on the ground."""
        return self.vehicle.vehicle_type.flies and self.autopilot.landed

    @property
    def restarts(self) -> bool:
        """True if entering the mission mode again restarts the mission."""
        return False

    # Uploads

    @abstractmethod
    def check(self, item: MissionItem) -> int:
        """Validate an item: MAV_MISSION_RESULT."""

    def may_replace(self, *, flying: bool, empty: bool) -> int:
        """Validate a replacement of the mission: MAV_MISSION_RESULT."""
        return _RESULT.ACCEPTED

    def replaced(self, mission: MissionRunner, was: int) -> None:  # noqa: B027 (optional)
        """React to a replaced mission; `was` is the current item before."""

    def problem(self, mission: MissionRunner) -> str | None:
        """Return why the mission cannot be flown at all; None if it can, or if there is none."""
        return None

    def valid(self, mission: MissionRunner) -> bool:
        """Return whether there is a mission that can be flown."""
        return mission.exists and self.problem(mission) is None

    # Flying

    @abstractmethod
    def navigates(self, item: MissionItem) -> bool:
        """Return whether an item ends a leg."""

    @abstractmethod
    def refusal(self, mission: MissionRunner) -> str | None:
        """Return why the mission cannot be flown now; None if it can."""

    def began(self, mission: MissionRunner) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts at the start of the mission."""

    def started(self, step: Step) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts at the start of an item."""

    def arrived(self, step: Step, hold: float) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts at a waypoint, before its hold time."""

    def waited(self, step: Step) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts after the hold time of a waypoint."""

    def reports(self, item: MissionItem) -> bool:
        """Return whether MISSION_ITEM_REACHED is sent at the end of an item."""
        return True

    def reported(self, mission: MissionRunner, seq: int) -> None:  # noqa: B027 (optional)
        """React to a MISSION_ITEM_REACHED that was sent."""

    def go_home(self, step: Step) -> Iterator[None]:
        """Change to the mode that returns to launch."""
        return step.mission.leave(self.autopilot.profile.return_to_launch, reason="mission item")

    @abstractmethod
    def finish(self, mission: MissionRunner) -> Iterator[None]:
        """Run after the last item."""
