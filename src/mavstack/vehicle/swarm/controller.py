"""The control loop of a swarm: ten times a second from positions to setpoints, with the guard beside it.

The loop takes one course at a time. Each step it reads the members' states, updates the roster, lets the
guard judge them, and sends a setpoint to each member that is present. If the guard finds a breach, the
members stand where they are, and the call that waits for the course ends in `SwarmStopped`. A vehicle that
leaves its mode, since a pilot or `mav swarm stop` took it, leaves the swarm and is not called back.

A leader that another program flies is not a member: members avoid it, and the guard counts it, but it has no
place in the course and gets no setpoints.

A course has its own time. It stops while no position arrives and while the program is held up, so that
setpoints continue where they were instead of jumping ahead of the vehicles; a course without an end, which
follows a vehicle, cannot wait and keeps the time of the clock.
"""

from __future__ import annotations

import asyncio
import logging
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import SwarmStopped
from mavstack.swarm.avoidance import Avoidance
from mavstack.swarm.courses import Standing
from mavstack.swarm.guard import Breach, Guard, GuardLimits
from mavstack.swarm.roster import Roster
from mavstack.swarm.separation import Margins
from mavstack.swarm.steering import steer_members
from mavstack.swarm.transitions import Limits
from mavstack.vehicle.swarm.member import RATE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.swarm.arrays import Points
    from mavstack.swarm.courses import Course
    from mavstack.vehicle.swarm.member import Member, State

logger = logging.getLogger("mavstack.vehicle")
_STEP: Final = 1.0 / RATE
#: Speed in m/s below which a member has arrived.
_SETTLED_SPEED: Final = 0.5
#: The distance in metres between a member and its slot at which a course has ended.
ARRIVAL_DISTANCE: Final = 1.0
#: Seconds after the end of a course in which its members have to arrive.
ARRIVAL_TIMEOUT: Final = 20.0
#: Maximum advance of a course in one step, in seconds.
_MAX_STEP: Final = 3.0 * _STEP
#: A course waits while the oldest position is older than this, in seconds.
_LATE: Final = 0.5
#: Seconds without a position of any member after which the swarm is stopped.
SILENCE_TIMEOUT: Final = 20.0


@dataclass(frozen=True, slots=True)
class SwarmOptions:
    """How a swarm flies.

    Attributes:
        margins: Errors against which plans protect; they give the planned distance.
        limits: Speeds and accelerations.
        guard: Limits that stop the swarm.
        avoid: True: members avoid each other in flight too.
        close_gaps: True: the slot of a lost member is taken by the next one at the next formation.
    """

    margins: Margins = field(default_factory=Margins)
    limits: Limits = field(default_factory=Limits)
    guard: GuardLimits = field(default_factory=GuardLimits)
    avoid: bool = True
    close_gaps: bool = True


class SwarmController:
    """Runs courses.

    Args:
        members: The members, the leader first.
        options: How the swarm flies.
        now: The clock in seconds.
    """

    def __init__(self, members: Sequence[Member], options: SwarmOptions, now: Callable[[], float]) -> None:
        self.members = tuple(members)
        self.options = options
        self.guard = Guard(options.guard)
        self.roster = Roster(
            (each.vehicle.system for each in members),
            timeout=options.guard.link_age,
            close_gaps=options.close_gaps,
        )
        self._now = now
        self._stopped: SwarmStopped | None = None
        self._progress = asyncio.Event()
        planned = options.margins.planned_distance
        self._avoidance = Avoidance(
            # Smaller than the planned distance, so that a course that keeps the planned distance is flown as
            # planned.
            distance=(options.margins.minimum + planned) / 2.0,
            speed=options.limits.speed,
            acceleration=options.limits.acceleration,
            step=_STEP,
        )
        self.stand()

    @property
    def active(self) -> list[Member]:
        """The members that follow setpoints and whose positions arrive, in order."""
        present = set(self.roster.present)
        return [each for each in self.members if each.is_following and each.vehicle.system in present]

    def places(self) -> Points:
        """Return the positions of the active members, in metres north, east, up."""
        return np.array([each.state()[0] for each in self.active]).reshape(-1, 3)

    async def run(self) -> None:
        """Run until the task is cancelled."""
        while True:
            self._step()
            self._progress.set()
            self._progress.clear()
            await asyncio.sleep(_STEP)

    def stand(self) -> None:
        """Let all members stay where they are."""
        self._begin(Standing(self.places()), self.active, ())

    def stop(self, reason: str, systems: Sequence[int] = ()) -> None:
        """Let all members stay where they are, and end the call that waits.

        Args:
            reason: The reason, a sentence.
            systems: System ids of the vehicles that caused it.
        """
        self._stopped = SwarmStopped(reason, tuple(systems))
        logger.warning("%s", self._stopped)
        self._begin(Standing(self.places()), self.active, self._others)

    async def fly(
        self,
        course: Course,
        members: Sequence[Member],
        *,
        until: float | None = None,
        others: Sequence[Member] = (),
    ) -> None:
        """Fly a course to its end.

        Args:
            course: The course, with a row for each of `members`.
            members: The members that fly it.
            until: Seconds after which a course without an end is left.
            others: Vehicles that are not members, which the members avoid and the guard counts.

        Raises:
            SwarmStopped: The guard or `stop` ended it, or all members were lost, or one did not arrive.
        """
        self._stopped = None
        self._begin(course, members, others)
        duration = course.duration if until is None else min(until, course.duration)
        try:
            while self._elapsed < duration or not self._arrived(duration):
                await self._progress.wait()
                if self._stopped is not None:
                    raise self._stopped
                if self._elapsed > duration + ARRIVAL_TIMEOUT:
                    late = [each.vehicle.system for each in self._late()]
                    names = "members" if not late else "vehicle " + ", ".join(map(str, late))
                    self.stop(f"{names} did not arrive at their slots", late)
        except asyncio.CancelledError:
            self.stand()
            raise

    def _begin(self, course: Course, members: Sequence[Member], others: Sequence[Member]) -> None:
        self._course, self._elapsed = course, 0.0
        self._flying, self._others = tuple(members), tuple(others)
        self._advanced = self._received = self._now()

    def _advance(self) -> None:
        """Advance the time of the course; see the head of the module."""
        now = self._now()
        step, self._advanced = now - self._advanced, now
        if min(each.age for each in self.members) <= _LATE:
            self._received = now
        elif now - self._received > SILENCE_TIMEOUT and self._stopped is None:
            self._stopped = SwarmStopped("no positions of the members arrive", ())
        if math.isinf(self._course.duration):
            self._elapsed += step
        elif not self._waits:
            self._elapsed += min(step, _MAX_STEP)

    @property
    def _waits(self) -> bool:
        """True while the course waits for positions."""
        return self._received != self._advanced and not math.isinf(self._course.duration)

    def _arrived(self, duration: float) -> bool:
        endless = math.isinf(self._course.duration) and duration < math.inf
        return endless or (bool(self.active) and not self._late())

    def _late(self) -> list[Member]:
        places, _ = self._course.state(self._elapsed)
        active = set(self.active)
        found = []
        for member, place in zip(self._flying, places, strict=True):
            position, velocity = member.state()
            far = float(np.linalg.norm(position - place)) > ARRIVAL_DISTANCE
            if member in active and (far or float(np.linalg.norm(velocity)) > _SETTLED_SPEED):
                found.append(member)
        return found

    def _step(self) -> None:
        self._update_roster()
        states = {each: each.state() for each in (*self.members, *self._others)}
        self._check_guard(np.array([position for position, _ in states.values()]))
        self._advance()
        places, motion = self._course.state(self._elapsed)
        if self._waits:
            motion = np.zeros_like(motion)
        present = set(self.active)
        active = [index for index, each in enumerate(self._flying) if each in present]
        if not active:
            # Members whose positions are late may return; meanwhile their last setpoints are streamed.
            if self._stopped is None and not any(each.is_following for each in self.members):
                self._stopped = SwarmStopped("no member follows setpoints any more", ())
            return
        flying = [self._flying[index] for index in active]
        course = places[active], motion[active]
        if self.options.avoid:
            course = self._avoiding(
                course, [states[each] for each in flying], [states[each] for each in self._others]
            )
        for member, place, velocity in zip(flying, *course, strict=True):
            member.follow(place, velocity)

    def _avoiding(
        self, course: tuple[Points, Points], members: list[State], others: list[State]
    ) -> tuple[Points, Points]:
        """Return the setpoints with which members avoid each other, and vehicles that are not members."""
        positions, velocities = _columns(members)
        if not np.isfinite(positions).all():
            return course
        known = [each for each in others if np.isfinite(each[0]).all()]
        steering = steer_members(positions, velocities, course, self._avoidance, _columns(known))
        return steering.places, steering.velocities

    def _update_roster(self) -> None:
        now = self._now()
        seen = {each.vehicle.system: now - each.age for each in self.members}
        change = self.roster.update(seen, now)
        for system in change.lost:
            logger.warning("vehicle %d was lost by its swarm: no position arrives", system)
        for member in self.members:
            if member.error is not None and member.vehicle.system in self.roster.present:
                self.roster.remove(member.vehicle.system)
                logger.warning("vehicle %d left its swarm: %s", member.vehicle.system, member.error)
        if change.leader is not None:
            logger.warning("vehicle %d leads the swarm now", change.leader)

    def _check_guard(self, positions: Points) -> None:
        vehicles = (*self.members, *self._others)
        for finding in self.guard.check(positions, [each.age for each in self.members]):
            if finding.breach is Breach.LINK:  # the roster handles lost links
                continue
            systems = [vehicles[index].vehicle.system for index in finding.members]
            names = " and ".join(f"vehicle {system}" for system in systems)
            self.stop(f"{finding.breach} of {names}: {finding.text}", systems)


def _columns(states: Sequence[State]) -> State:
    """Return the positions and the velocities of vehicles, two arrays of shape (n, 3)."""
    return np.array([each for each, _ in states]).reshape(-1, 3), np.array(
        [each for _, each in states]
    ).reshape(-1, 3)
