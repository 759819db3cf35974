"""The mission runner: it flies the mission leg by leg, in the mission mode.

A leg is one NAV item with the DO and CONDITION items before it (`route.py`). Each item is a small script
(`scripts.py`). External changes (another current item, a new plan, a pause) take effect at the next tick. A
script does not change the mode itself, since that would end the script in the middle of a step: it calls
`leave` or `later`, which act before the next tick.
"""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import CurrentItemSet, Plan, PlanReplaced, PlanType
from mavstack.sim.autopilot.course import Course
from mavstack.sim.autopilot.mission.factory import rules_of
from mavstack.sim.autopilot.mission.guided_limits import GuidedLimits
from mavstack.sim.autopilot.mission.leg_flight import ENDED, fly_leg
from mavstack.sim.autopilot.mission.route import Leg, Route
from mavstack.sim.autopilot.mission.rules import Step
from mavstack.sim.autopilot.mission.validation import validate_item, validate_plan
from mavstack.sim.autopilot.terrain import following

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem, MissionServer
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.maneuvers import Point

_STATE = common.MissionState
_CMD = common.MavCmd
#: Values of `mission_mode` in MISSION_CURRENT.
IN_MISSION, SUSPENDED = 1, 2
#: Maximum number of legs in one tick: a leg to the current position takes no time, so a jump could loop
#: forever.
_MAX_LEGS = 10


class MissionRunner:
    """The mission of one vehicle; one of its autopilot's watches."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self.autopilot = autopilot
        self.rules = rules_of(autopilot)
        self.course = Course(autopilot, autopilot.payload)
        #: The behaviour that the current item runs, such as a takeoff.
        self.part: Behaviour | None = None
        self.guided_limits = GuidedLimits()
        #: True if a command made a VTOL hover between waypoints.
        self.hovers = False
        self.paused = False
        self._paused_for = 0.0
        self._route: Route | None = None
        self._next: int | None = None
        self._last: int | None = None
        self._interrupted = self._complete = self._flying = self._begins_at_commanded_item = False
        self._at = 0
        self._ticked = autopilot.now
        self._later: list[tuple[float, Callable[[], object]]] = []
        #: The item that is being flown, which may belong to a plan that was replaced meanwhile.
        self.flown: MissionItem | None = None
        #: The last point to which the mission flew; the next line starts there.
        self.origin: Point | None = None
        autopilot.watches.append(self)
        autopilot.vehicle.on_event(PlanReplaced, self._plan_replaced)
        autopilot.vehicle.on_event(CurrentItemSet, self._current_set)

    # State

    @property
    def server(self) -> MissionServer:
        """The server of the mission protocol."""
        return self.autopilot.vehicle.mission

    @property
    def items(self) -> tuple[MissionItem, ...]:
        """The items of the mission."""
        return self.autopilot.vehicle.plans.get(PlanType.MISSION).items

    @property
    def exists(self) -> bool:
        """True if there is an item to fly."""
        return len(self.items) > self.rules.first

    @property
    def first(self) -> int:
        """The sequence number of the first item that is flown."""
        return self.rules.first

    @property
    def sequence(self) -> int:
        """The sequence number of the current item."""
        return self.server.current

    @property
    def state(self) -> int:
        """MISSION_STATE."""
        return self.server.state if self.exists else _STATE.NO_MISSION

    @property
    def flying(self) -> bool:
        """True while the mission is flown."""
        return self._flying

    @property
    def now(self) -> float:
        """Mission time: the clock stops while the mission is paused."""
        return self.autopilot.now - self._paused_for

    @property
    def route(self) -> Route:
        """The order of the items."""
        items = self.items
        if self._route is None or self._route.items is not items:
            self._route = Route(items, self.rules.first, self.rules.navigates)
        return self._route

    # Control

    def valid(self) -> bool:
        """Return whether there is a mission that can be flown."""
        return self.rules.valid(self)

    def refusal(self) -> str | None:
        """Return why the mission mode cannot be entered now; None if it can."""
        return self.rules.refusal(self)

    def start(self, first: int = 0, last: int = 0) -> str | None:
        """Fly the mission.

        Args:
            first: The first item; 0 for the first or the current one.
            last: The last item; 0 for the end of the mission.

        Returns:
            The reason for a refusal; None if the mission is flown now.
        """
        count = len(self.items)
        if not (0 <= first < max(count, 1) and 0 <= last < max(count, 1)) or (last and last < first):
            return f"The mission has no items {first} to {last}"
        problem = self.refusal()
        if problem is not None:
            return problem
        if first:
            self.go_to_item(first)
            self._begins_at_commanded_item = True
        self._last = last or None
        autopilot = self.autopilot
        if not autopilot.enter(autopilot.profile.mission, "mission start"):
            return "The mission needs a position"
        return None

    def pause(self) -> bool:
        """Hold the position; returns False if no mission is flown."""
        if self._flying and not self.paused:
            self.paused = True
            self._set_state(_STATE.PAUSED)
            self.autopilot.maneuvers.hold()
        return self._flying

    def resume(self) -> bool:
        """Continue after a pause; returns False if no mission is flown."""
        if self._flying and self.paused:
            self.paused = False
            self._set_state(_STATE.ACTIVE)
            if self.course.point is not None:
                self.course.keep(again=True)
            else:
                self._interrupted = True
        return self._flying

    def reset(self) -> None:
        """Start from the first item at the next flight."""
        self._next, self._last, self._complete = self.rules.first, None, False
        self.route.reset_jumps()
        if self.server.state != _STATE.COMPLETE:
            self._set_state(_STATE.NOT_STARTED)

    def go_to_item(self, seq: int, *, reset: bool = False) -> bool:
        """Continue at an item; returns False if there is none."""
        if not 0 <= seq < len(self.items):
            return False
        if reset or seq < self.rules.first or self._complete:
            self.route.reset_jumps()
        self.begin_at(max(seq, self.rules.first))
        return True

    def begin_at(self, seq: int) -> None:
        """Continue at an item, or end the mission if `seq` is past the last one."""
        self._next, self._complete, self._interrupted = seq, False, True
        self.set_current(seq)

    def landing_start(self) -> int | None:
        """Return the nearest DO_LAND_START, None if the mission has none."""
        found = (seq for seq, item in enumerate(self.items) if item.command == _CMD.DO_LAND_START)
        return min(found, key=self._distance_to, default=None)

    def _distance_to(self, seq: int) -> float:
        """Return the distance to an item; its sequence number if it has no position."""
        step = Step(self, seq, self.items[seq])
        return step.maneuvers.distance(step.place()) if step.has_place else float(seq)

    # Interface for the services

    def check(self, kind: int, seq: int, item: MissionItem) -> int:
        """Validate one item of an upload: MAV_MISSION_RESULT."""
        return validate_item(self.rules, kind, item)

    def validate(self, plan: Plan, source: Address) -> int:
        """Validate a whole plan: MAV_MISSION_RESULT."""
        return validate_plan(self.rules, plan, flying=self._flying)

    # Interface for the scripts of mission items

    def later(self, act: Callable[[], object], *, after: float = 0.0) -> None:
        """Call `act` before the next tick, or after some seconds."""
        self._later.append((self.autopilot.now + after, act))

    def leave(self, *modes: int, reason: str) -> Iterator[None]:
        """Enter another mode, or several in turn, unless the mode changes otherwise; wait for the change."""
        autopilot, mine = self.autopilot, self.autopilot.behaviour
        self.later(lambda: autopilot.behaviour is mine and [autopilot.enter(mode, reason) for mode in modes])
        while True:
            yield

    def hand_over(self, seq: int) -> bool:
        """Complete an item that continues outside the mission; returns whether it was the last one."""
        if self._next is None or self.route.leg(self._next) is None:
            self._end()
        self.report_reached(seq)
        return self._complete

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Send a STATUSTEXT."""
        self.autopilot.vehicle.send_statustext(text, severity)

    def set_course(self, point: Point, *, start: Point | None = None, yaw: float | None = None) -> None:
        """Fly a line to a point, from the last point of the mission unless `start` is given."""
        begin = start or self._line_begin(point)
        follow = following(self.autopilot, self.flown, begin, point)
        self.course.set(point, start=begin, yaw=yaw, follow=follow)
        self.origin = point

    def keep_course(self) -> None:
        """Apply changes of speed and heading to the current line."""
        self.course.keep()

    def _line_begin(self, point: Point) -> Point:
        """Return the last point, or the current position if the vehicle is far from the line."""
        here = self.autopilot.maneuvers.place
        if self.origin is None or self.origin[:2] == point[:2]:
            return here
        reach = 2 * max(self.autopilot.flight_parameters.acceptance_radius, 5.0)
        return self.origin if self.autopilot.maneuvers.distance(self.origin) <= reach else here

    # Flying

    def tick(self, now: float) -> None:
        """Run the deferred actions."""
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
                    self.autopilot.maneuvers.yaw = None
                    yield from fly_leg(self, leg)
                if legs % _MAX_LEGS == 0:
                    yield
        finally:
            self._leave()

    def _enter(self) -> None:
        self._flying, self.paused, self.hovers = True, False, False
        self.origin = None
        self.course.clear()
        if self._complete or (self.rules.restarts and not self._begins_at_commanded_item):
            last = self._last
            self.reset()
            self._last = last
        self._begins_at_commanded_item = False
        if self._next is None:
            self._next = max(self.sequence, self.rules.first)
        self._set_state(_STATE.ACTIVE if self.exists else self.server.state)
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
        self._set_state(_STATE.COMPLETE if self._complete else _STATE.PAUSED)

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
            self._set_state(_STATE.COMPLETE)

    def _finish(self) -> Iterator[None]:
        self._end()
        yield from self.until_interrupted(self.rules.finish(self))
        while not self._interrupted:
            yield
        self._set_state(_STATE.ACTIVE)

    def until_interrupted(self, script: Iterator[None]) -> Iterator[None]:
        """Run a script until the mission is interrupted; a pause suspends it."""
        while not self._interrupted:
            if not self.paused and next(script, ENDED) is ENDED:
                return
            yield

    # Reports

    def report_reached(self, seq: int) -> None:
        """Send MISSION_ITEM_REACHED."""
        self.server.reached(seq)
        self._touch()
        self.rules.reported(self, seq)

    def set_current(self, seq: int) -> None:
        """Make an item the current one, if the mission has it."""
        if 0 <= seq < len(self.items):
            self._at = seq
            if self.server.current != seq:
                self.server.set_current(seq)
                self._touch()

    def _set_state(self, state: int) -> None:
        mode = IN_MISSION if self._flying else SUSPENDED
        server = self.server
        if (server.state, server.mode) != (state, mode):
            server.state, server.mode = state, mode
            server.send(server.current_message())
            self._touch()

    def _touch(self) -> None:
        self.autopilot.vehicle.touch(self.server)

    # Events of the mission protocol

    def _plan_replaced(self, event: PlanReplaced) -> None:
        if event.plan.type != PlanType.MISSION:
            return
        was, self._at = self._at, self.server.current
        if not self._flying:
            self._next, self._complete = None, False
            self._set_state(_STATE.NOT_STARTED)
        self.rules.replaced(self, was)

    def _current_set(self, event: CurrentItemSet) -> None:
        self._at = event.seq
        self.go_to_item(event.seq, reset=event.restart)
