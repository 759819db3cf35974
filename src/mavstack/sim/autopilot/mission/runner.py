"""Flies the mission: leg by leg, in the mode that is for it.

A leg is one item that navigates, and those before it that only do something (`route.py`). Each item is a
small script (`scripts.py`). What comes from outside while it is flown (another current item, another
mission, a pause) is noticed at the next tick. A script does not change the mode, for that would end it in
the middle of a step: it asks by `leave` or `later`, and it is done before the next tick.
"""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import CurrentItemSet, Plan, PlanReplaced, PlanType
from mavstack.sim.autopilot.mission.course import Course
from mavstack.sim.autopilot.mission.factory import rules_of
from mavstack.sim.autopilot.mission.guided_limits import GuidedLimits
from mavstack.sim.autopilot.mission.interfaces import Step
from mavstack.sim.autopilot.mission.route import Leg, Route
from mavstack.sim.autopilot.mission.scripts import script_of
from mavstack.sim.autopilot.mission.validation import judge_item, judge_plan

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem, MissionServer
    from mavstack.sim.autopilot.control import RunningBehaviour
    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.autopilot.maneuvers import Point

_STATE = common.MissionState
_CMD = common.MavCmd
#: `mission_mode` of MISSION_CURRENT.
IN_MISSION, SUSPENDED = 1, 2
#: So many legs are flown in one tick at most: one to where the vehicle is takes no time, and jumps go round.
_MOST_LEGS = 10


class MissionRunner:
    """The mission of one vehicle; one of its autopilot's watches."""

    def __init__(self, autopilot: Autopilot) -> None:
        self.autopilot = autopilot
        self.rules = rules_of(autopilot)
        self.course = Course(autopilot, autopilot.payload)
        #: What a mode does that an item does just now, such as a take-off.
        self.part: RunningBehaviour | None = None
        self.guided_limits = GuidedLimits()
        #: Whether a VTOL was told to hover on its way.
        self.hovers = False
        self.paused = False
        self._paused_for = 0.0
        self._route: Route | None = None
        self._next: int | None = None
        self._last: int | None = None
        self._interrupted = self._complete = self._flying = self._begins_where_told = False
        self._at = 0
        self._ticked = autopilot.now
        self._later: list[tuple[float, Callable[[], object]]] = []
        #: The item that is flown now, whatever became of the mission.
        self.flown: MissionItem | None = None
        #: The last point that the mission went to: where the next line begins.
        self.origin: Point | None = None
        autopilot.watches.append(self)
        autopilot.vehicle.on_event(PlanReplaced, self._plan_replaced)
        autopilot.vehicle.on_event(CurrentItemSet, self._current_set)

    # What it is doing

    @property
    def server(self) -> MissionServer:
        """The vehicle's side of the mission protocol."""
        return self.autopilot.vehicle.mission

    @property
    def items(self) -> tuple[MissionItem, ...]:
        """The mission."""
        return self.autopilot.vehicle.plans.get(PlanType.MISSION).items

    @property
    def exists(self) -> bool:
        """Whether there is anything to fly."""
        return len(self.items) > self.rules.first

    @property
    def first(self) -> int:
        """The sequence number of the first item that is flown."""
        return self.rules.first

    @property
    def sequence(self) -> int:
        """The current item."""
        return self.server.current

    @property
    def state(self) -> int:
        """MISSION_STATE."""
        return self.server.state if self.exists else _STATE.NO_MISSION

    @property
    def flying(self) -> bool:
        """Whether the mission is flown now."""
        return self._flying

    @property
    def now(self) -> float:
        """Time that stands still in a pause."""
        return self.autopilot.now - self._paused_for

    @property
    def route(self) -> Route:
        """The way through the items."""
        items = self.items
        if self._route is None or self._route.items is not items:
            self._route = Route(items, self.rules.first, self.rules.navigates)
        return self._route

    # What others ask of it

    def valid(self) -> bool:
        """Return whether there is a mission that can be flown."""
        return self.rules.valid(self)

    def refusal(self) -> str | None:
        """Why the mission mode may not be entered now; None if it may."""
        return self.rules.refusal(self)

    def start(self, first: int = 0, last: int = 0) -> str | None:
        """Fly the mission from an item (0: its beginning, or where it was) to another (0: the end).

        Gives the reason why not, None if it is flown.
        """
        count = len(self.items)
        if not (0 <= first < max(count, 1) and 0 <= last < max(count, 1)) or (last and last < first):
            return f"The mission has no items {first} to {last}"
        problem = self.refusal()
        if problem is not None:
            return problem
        if first:
            self.go_to_item(first)
            self._begins_where_told = True
        self._last = last or None
        autopilot = self.autopilot
        if not autopilot.enter(autopilot.profile.mission, "mission start"):
            return "The mission needs a position"
        return None

    def pause(self) -> bool:
        """Stay where it is; False if no mission is flown."""
        if self._flying and not self.paused:
            self.paused = True
            self._show(_STATE.PAUSED)
            self.autopilot.maneuvers.hold()
        return self._flying

    def resume(self) -> bool:
        """Go on after a pause; False if no mission is flown."""
        if self._flying and self.paused:
            self.paused = False
            self._show(_STATE.ACTIVE)
            if self.course.point is not None:
                self.course.keep(again=True)
            else:
                self._interrupted = True
        return self._flying

    def reset(self) -> None:
        """Begin anew when it is flown next."""
        self._next, self._last, self._complete = self.rules.first, None, False
        self.route.forget_jumps()
        if self.server.state != _STATE.COMPLETE:
            self._show(_STATE.NOT_STARTED)

    def go_to_item(self, seq: int, *, reset: bool = False) -> bool:
        """Go on at an item; False if there is none."""
        if not 0 <= seq < len(self.items):
            return False
        if reset or seq < self.rules.first or self._complete:
            self.route.forget_jumps()
        self.begin_at(max(seq, self.rules.first))
        return True

    def begin_at(self, seq: int) -> None:
        """Go on at an item, or end if it is behind the last one."""
        self._next, self._complete, self._interrupted = seq, False, True
        self._move_to(seq)

    def restore(self, seq: int) -> None:
        """Keep the current item that was, if another mission has one at its place."""
        self._move_to(seq)

    def landing_start(self) -> int | None:
        """The nearest DO_LAND_START."""
        found = (seq for seq, item in enumerate(self.items) if item.command == _CMD.DO_LAND_START)
        return min(found, key=self._distance_to, default=None)

    def _distance_to(self, seq: int) -> float:
        """Return the distance to an item; its sequence number if it has no position."""
        step = Step(self, seq, self.items[seq])
        return step.maneuvers.distance(step.place()) if step.has_place else float(seq)

    # For the services

    def check(self, kind: int, seq: int, item: MissionItem) -> int:
        """Judge one item of an upload: MAV_MISSION_RESULT."""
        return judge_item(self.rules, kind, item)

    def validate(self, plan: Plan, source: Address) -> int:
        """Judge a whole plan: MAV_MISSION_RESULT."""
        return judge_plan(self.rules, plan, flying=self._flying)

    # For the scripts

    def later(self, act: Callable[[], object], *, after: float = 0.0) -> None:
        """Do something that a script cannot do itself: before the next tick, or after some seconds."""
        self._later.append((self.autopilot.now + after, act))

    def leave(self, *modes: int, reason: str) -> Iterator[None]:
        """Enter another mode, or several in turn, unless somebody else does meanwhile; wait until then."""
        autopilot, mine = self.autopilot, self.autopilot.behaviour
        self.later(lambda: autopilot.behaviour is mine and [autopilot.enter(mode, reason) for mode in modes])
        while True:
            yield

    def hand_over(self, seq: int) -> bool:
        """An item goes on outside the mission, so it counts as done; whether it was the last one."""
        if self._next is None or self.route.leg(self._next) is None:
            self._end()
        self._tell_reached(seq)
        return self._complete

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Say something by STATUSTEXT."""
        self.autopilot.vehicle.send_statustext(text, severity)

    def set_course(self, point: Point, *, start: Point | None = None, yaw: float | None = None) -> None:
        """Fly a line to a point, from where the mission was last unless `start` says else."""
        self.course.set(point, start=start or self._line_begin(point), yaw=yaw)
        self.origin = point

    def keep_course(self) -> None:
        """Take changes of speed and heading into account."""
        self.course.keep()

    def _line_begin(self, point: Point) -> Point:
        """The last point, unless the vehicle is far from the line that it would begin."""
        here = self.autopilot.maneuvers.place
        if self.origin is None or self.origin[:2] == point[:2]:
            return here
        reach = 2 * max(self.autopilot.flight_parameters.acceptance_radius, 5.0)
        return self.origin if self.autopilot.maneuvers.distance(self.origin) <= reach else here

    # Flying

    def tick(self, now: float) -> None:
        """Do what scripts asked for."""
        due = [act for at, act in self._later if at <= now]
        self._later = [(at, act) for at, act in self._later if at > now]
        for act in due:
            act()
        if self.paused:
            self._paused_for += now - self._ticked
        self._ticked = now
        if self._flying and not self.autopilot.armed:
            self._flying = False

    def fly(self) -> Iterator[None]:
        """Fly the mission; ends only by leaving the mode."""
        self._enter()
        try:
            for legs in count(1):
                self._interrupted = False
                leg = self._take_leg()
                if leg is None:
                    yield from self._finish()
                else:
                    yield from self._fly_leg(leg)
                if legs % _MOST_LEGS == 0:
                    yield
        finally:
            self._leave()

    def _enter(self) -> None:
        self._flying, self.paused, self.hovers = True, False, False
        self.origin = None
        self.course.forget()
        if self._complete or (self.rules.restarts and not self._begins_where_told):
            last = self._last
            self.reset()
            self._last = last
        self._begins_where_told = False
        if self._next is None:
            self._next = max(self.sequence, self.rules.first)
        self._show(_STATE.ACTIVE if self.exists else self.server.state)
        self.rules.began(self)

    def _leave(self) -> None:
        self._flying = self.paused = False
        self.part = None
        self.autopilot.maneuvers.reset_choices()
        self._last = None
        if self._complete:
            self._next = None
        elif self.exists:
            self._next = self.sequence
        self._show(_STATE.COMPLETE if self._complete else _STATE.PAUSED)

    def _take_leg(self) -> Leg | None:
        start = self._next if self._next is not None else self.rules.first
        if self._last is not None and start > self._last:
            return None
        leg = self.route.leg(start)
        if leg is not None:
            self._next = leg.then
        return leg

    def _end(self) -> None:
        if not self._complete:
            self._complete = True
            self._show(_STATE.COMPLETE)

    def _finish(self) -> Iterator[None]:
        self._end()
        yield from self._while_undisturbed(self.rules.finish(self))
        while not self._interrupted:
            yield
        self._show(_STATE.ACTIVE)

    def _fly_leg(self, leg: Leg) -> Iterator[None]:
        items = self.items
        self.autopilot.maneuvers.yaw = None
        actions = self._act(leg, items)
        if not self.rules.actions_meanwhile:
            yield from self._while_undisturbed(actions)
        if leg.navigation is None:
            yield from self._while_undisturbed(actions)
            return
        navigation = self._perform(leg.navigation, items[leg.navigation])
        yield from self._while_undisturbed(self._beside(navigation, actions))

    def _beside(self, navigation: Iterator[None], actions: Iterator[None]) -> Iterator[None]:
        """The item that navigates, and what is done meanwhile: its end ends both."""
        while True:
            next(actions, None)
            if next(navigation, _ENDED) is _ENDED:
                return
            yield

    def _while_undisturbed(self, script: Iterator[None]) -> Iterator[None]:
        """Run a script until something else is wanted; a pause holds it up."""
        while not self._interrupted:
            if not self.paused and next(script, _ENDED) is _ENDED:
                return
            yield

    def _act(self, leg: Leg, items: Sequence[MissionItem]) -> Iterator[None]:
        for seq in leg.actions:
            yield from self._perform(seq, items[seq])
            if self.rules.actions_meanwhile:
                yield

    def _perform(self, seq: int, item: MissionItem) -> Iterator[None]:
        step = Step(self, seq, item)
        if self.rules.navigates(item) or not self.rules.actions_meanwhile:
            self._move_to(seq)
            self.flown = item
        self.rules.started(step)
        yield from script_of(item.command)(step)
        if self.rules.reports(item):
            self._tell_reached(seq)

    # Telling

    def _tell_reached(self, seq: int) -> None:
        self.server.reached(seq)
        self._touch()
        self.rules.reported(self, seq)

    def _move_to(self, seq: int) -> None:
        if 0 <= seq < len(self.items):
            self._at = seq
            if self.server.current != seq:
                self.server.set_current(seq)
                self._touch()

    def _show(self, state: int) -> None:
        mode = IN_MISSION if self._flying else SUSPENDED
        server = self.server
        if (server.state, server.mode) != (state, mode):
            server.state, server.mode = state, mode
            server.send(server.current_message())
            self._touch()

    def _touch(self) -> None:
        self.autopilot.vehicle.touch(self.server)

    # What comes from outside

    def _plan_replaced(self, event: PlanReplaced) -> None:
        if event.plan.type != PlanType.MISSION:
            return
        was, self._at = self._at, self.server.current
        if not self._flying:
            self._next, self._complete = None, False
            self._show(_STATE.NOT_STARTED)
        self.rules.replaced(self, was)

    def _current_set(self, event: CurrentItemSet) -> None:
        self._at = event.seq
        self.go_to_item(event.seq, reset=event.reset)


_ENDED = object()
