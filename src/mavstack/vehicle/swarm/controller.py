"""The control loop of a swarm: ten times a second from positions to setpoints, with the guard beside it.

The loop takes one course at a time. Each step it reads the members' states, updates the roster, lets the
guard judge them, and sends a setpoint to each member that is present. A setpoint is the place of the course
after the delay with which the member follows (`mavstack.swarm.delays`). If the guard finds a breach, the
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
from mavstack.swarm.delays import Delays
from mavstack.swarm.guard import Breach, Guard, GuardLimits
from mavstack.swarm.pace import Pace
from mavstack.swarm.roster import Roster
from mavstack.swarm.separation import Margins
from mavstack.swarm.steering import steer_members
from mavstack.swarm.transitions import Limits
from mavstack.vehicle.swarm.fleet import Setpoints
from mavstack.vehicle.swarm.member import RATE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Indices, Points
    from mavstack.swarm.courses import Course
    from mavstack.swarm.formations import Formation
    from mavstack.swarm.steering import Steering
    from mavstack.vehicle.swarm.fleet import Fleet, Readings
    from mavstack.vehicle.swarm.member import Member

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
        close_gaps: True: the next formation has no slot for a lost member. False: the slot stays empty, apart
            from the leader's.
    """

    margins: Margins = field(default_factory=Margins)
    limits: Limits = field(default_factory=Limits)
    guard: GuardLimits = field(default_factory=GuardLimits)
    avoid: bool = True
    close_gaps: bool = True


class SwarmController:
    """Runs courses.

    Args:
        fleet: The members, the leader first.
        options: How the swarm flies.
    """

    def __init__(self, fleet: Fleet, options: SwarmOptions) -> None:
        self.members = fleet.members
        self.options = options
        self.guard = Guard(options.guard)
        self.roster = Roster(
            (each.system for each in fleet.members),
            timeout=options.guard.link_age,
            close_gaps=options.close_gaps,
        )
        self._fleet = fleet
        self._indices = {each: index for index, each in enumerate(fleet.members)}
        self._stopped: SwarmStopped | None = None
        self._ended = False
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
        self.delays = Delays(len(fleet.members), options.margins.latency)
        self.stand()

    @property
    def active(self) -> list[Member]:
        """The members that follow setpoints and whose positions arrive, in order."""
        return [self.members[index] for index in self._active_of(self.members)]

    @property
    def progress(self) -> tuple[float, float]:
        """The seconds since the course began, and until its end; infinite if it has none."""
        return self._elapsed, self._course.duration

    def places(self) -> Points:
        """Return the positions of the active members, in metres north, east, up."""
        return self._fleet.read().positions[self._rows_of(self.active)]

    def offsets(self, formation: Formation, members: Sequence[Member], leaders: int = 0) -> Points:
        """Return the slots of members in a formation, without those of lost members or with gaps for them.

        Args:
            formation: The formation.
            members: The members that fly it, which are active.
            leaders: The number of its first slots that belong to vehicles which are not members.

        Returns:
            Metres forward, right, up; an array of shape (members, 3).

        Raises:
            InvalidArgumentError: The formation has another number of slots.
        """
        slots = self.roster.slots
        count = len(slots) if self.options.close_gaps else len(self.members)
        taken = [leaders + slots[each.system] for each in members]
        found: Points = formation.offsets(leaders + count)[taken]
        return found

    async def run(self) -> None:
        """Run until the task is cancelled; a call that waits for a course then ends in `SwarmStopped`."""
        try:
            while True:
                self._step()
                self._progress.set()
                self._progress.clear()
                await asyncio.sleep(_STEP)
        finally:
            self._ended = True
            self._progress.set()

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
            # A pause at the end of a course also holds back the next course of the same call.
            while self._elapsed < duration or self.pace.paused or not self._arrived(duration):
                await self._progress.wait()
                if self._ended:
                    raise SwarmStopped("the control loop of the swarm has ended", ())
                if self._stopped is not None:
                    raise self._stopped
                if self._elapsed > duration + ARRIVAL_TIMEOUT:
                    late = [each.system for each in self._late()]
                    names = "members" if not late else "vehicle " + ", ".join(map(str, late))
                    self.stop(f"{names} did not arrive at their slots", late)
        except asyncio.CancelledError:
            self.stand()
            raise

    def _begin(self, course: Course, members: Sequence[Member], others: Sequence[Member]) -> None:
        self._course, self._elapsed = course, 0.0
        self._flying, self._others = tuple(members), tuple(others)
        self._advanced = self._received = self._fleet.now()
        self.pace = Pace()

    def _active_of(self, members: Sequence[Member]) -> list[int]:
        """Return the indices of those of some members that are active."""
        absent = self.roster.absent
        return [
            index for index, each in enumerate(members) if each.is_following and each.system not in absent
        ]

    def _rows_of(self, members: Sequence[Member]) -> Indices:
        return np.array([self._indices[each] for each in members], dtype=np.int64)

    def _advance(self, youngest: float) -> float:
        """Advance the time of the course, and return by how much; see the head of the module.

        Args:
            youngest: Seconds since the last position of any member was received.
        """
        now = self._fleet.now()
        step, self._advanced = now - self._advanced, now
        if youngest <= _LATE:
            self._received = now
        elif now - self._received > SILENCE_TIMEOUT and self._stopped is None:
            self.stop("no positions of the members arrive")
        if not math.isinf(self._course.duration):
            step = 0.0 if self._waits else self.pace.advance(min(step, _MAX_STEP))
        self._elapsed += step
        return step

    @property
    def _waits(self) -> bool:
        """True while the course waits for positions."""
        return self._received != self._advanced and not math.isinf(self._course.duration)

    def _arrived(self, duration: float) -> bool:
        endless = math.isinf(self._course.duration) and duration < math.inf
        return endless or (bool(self.active) and not self._late())

    def _late(self) -> list[Member]:
        """Return the active members that have not arrived at their places."""
        places, _ = self._course.state(self._elapsed)
        found = self._fleet.read().take(self._rows_of(self._flying))
        far = np.linalg.norm(found.positions - places, axis=1) > ARRIVAL_DISTANCE
        moves = np.linalg.norm(found.velocities, axis=1) > _SETTLED_SPEED
        active = set(self.active)
        return [self._flying[index] for index in np.flatnonzero(far | moves) if self._flying[index] in active]

    def _step(self) -> None:
        self._fleet.check()
        readings, count = self._fleet.read(self._others), len(self.members)
        ages = readings.ages[:count]
        self._update_roster(ages)
        self._check_guard(readings)
        step = self._advance(float(ages.min()))
        active = self._active_of(self._flying)
        flying = [self._flying[index] for index in active]
        if not active and self._stopped is None and not any(each.is_following for each in self.members):
            # Members whose positions are late may return; meanwhile they stand at their last ones.
            self.stop("no member follows setpoints any more")
        rows = self._rows_of(flying)
        states, others = readings.take(rows), readings.take(slice(count, None))
        places, motion = (each[active] for each in self._course.state(self._elapsed))
        course = places, motion * (0.0 if self._waits else self.pace.rate)
        steering = self._steering(course, states, others)
        free = np.ones(len(rows), bool) if steering is None else ~steering.deviates
        if not self._waits:
            learning = np.flatnonzero(free & (states.ages <= _LATE))
            behind = (places - states.positions)[learning]
            self.delays.learn(rows[learning], behind, course[1][learning], min(step, _MAX_STEP))
        setpoints = self._ahead(rows, active, course)
        if steering is not None:
            setpoints = _around(steering, setpoints)
        self._fleet.send(flying, setpoints, states.heights)

    def _steering(
        self, course: tuple[Points, Points], members: Readings, others: Readings
    ) -> Steering | None:
        """Return how members avoid each other and other vehicles; None: they fly their course."""
        if not self.options.avoid or not np.isfinite(members.positions).all():
            return None
        known = others.take(np.flatnonzero(np.isfinite(others.positions).all(axis=1)))
        return steer_members(
            members.positions,
            members.velocities,
            course,
            self._avoidance,
            (known.positions, known.velocities),
        )

    def _ahead(self, rows: Indices, flying: list[int], course: tuple[Points, Points]) -> Setpoints:
        """Return the places of the course after the delay of each member.

        Args:
            rows: The indices of the members.
            flying: Their rows of the course.
            course: Places and velocities now.
        """
        still = np.zeros((len(rows), 3))
        if self._waits:
            return Setpoints(*course, still)
        if math.isinf(self._course.duration):  # a leader's motion is not known in advance
            return Setpoints(*self.delays.lead(rows, (*course, still)), still)
        rate, after = self.pace.rate, float(np.median(self.delays.seconds))
        places, motion = (each[flying] for each in self._course.state(self._elapsed + rate * after))
        _, later = self._course.state(self._elapsed + rate * after + _STEP)
        acceleration = rate**2 * (later[flying] - motion) / _STEP + self.pace.slope * motion
        lead = self.delays.lead(rows, (places, rate * motion, acceleration), after)
        return Setpoints(*lead, acceleration)

    def _update_roster(self, ages: Points) -> None:
        now = self._fleet.now()
        systems = (each.system for each in self.members)
        change = self.roster.update(dict(zip(systems, (now - ages).tolist(), strict=True)), now)
        for system in change.lost:
            logger.warning("vehicle %d was lost by its swarm: no position arrives", system)
        for member in self.members:
            if member.error is not None and member.system in self.roster.present:
                self.roster.remove(member.system)
                logger.warning("vehicle %d left its swarm: %s", member.system, member.error)
        if change.leader is not None:
            logger.warning("vehicle %d leads the swarm now", change.leader)

    def _check_guard(self, readings: Readings) -> None:
        vehicles = (*self.members, *self._others)
        for finding in self.guard.check(readings.positions, readings.ages[: len(self.members)]):
            if finding.breach is Breach.LINK:  # the roster handles lost links
                continue
            systems = [vehicles[index].system for index in finding.members]
            names = " and ".join(f"vehicle {system}" for system in systems)
            self.stop(f"{finding.breach} of {names}: {finding.text}", systems)


def _around(steering: Steering, course: Setpoints) -> Setpoints:
    """Return the setpoints of the course, apart from members that avoid another vehicle."""
    off_course = steering.deviates[:, None]
    return Setpoints(
        np.where(off_course, steering.places, course.places),
        np.where(off_course, steering.velocities, course.velocities),
        np.where(off_course, 0.0, course.accelerations),
    )
