"""A swarm: vehicles that fly in formation, move together, and stop together.

    async with connection.swarm(1, 2, 3) as swarm:          # armed and in the air
        await swarm.formation("wedge", spacing=8)
        await swarm.move(north=100)
        await swarm.rotate(90)

Inside of the block the vehicles follow setpoints; at its end each holds where it is. A call returns when
every member has arrived. A call that is refused, since the slots are too near to each other, changes
nothing. PX4 and ArduPilot, copters and rovers can be mixed; wings cannot stand in a slot and are refused
(`ActionUnsupported`).
"""

from __future__ import annotations

import asyncio
import math
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from mavstack.dialects import common
from mavstack.errors import ContactLost, GroupError, InvalidArgumentError, SwarmStopped
from mavstack.geodesy import LocalFrame
from mavstack.node.api_object import ReadOnly
from mavstack.services.arguments import check_numbers
from mavstack.swarm.courses import Following, Turn
from mavstack.swarm.formations import Formation, default_spacing, rotate_to_course
from mavstack.swarm.leader import LeaderFrame, turn_rate_for
from mavstack.swarm.separation import import_libraries
from mavstack.swarm.shows.check import ShowLimits
from mavstack.swarm.shows.show import ShowCourse, placed
from mavstack.swarm.transitions import Transition, plan_transition, straight_transition
from mavstack.vehicle.swarm.checks import check_heights, check_show_of
from mavstack.vehicle.swarm.controller import SwarmController, SwarmOptions
from mavstack.vehicle.swarm.fleet import LOWEST_SLOT, Fleet
from mavstack.vehicle.swarm.leader_watch import fly_with_leader, measure
from mavstack.vehicle.swarm.member import RATE, Member

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable
    from types import TracebackType
    from typing import Self

    from mavstack.swarm.arrays import Points
    from mavstack.swarm.shows.show import Show
    from mavstack.vehicle.vehicle import Vehicle


class Swarm(ReadOnly):
    """Vehicles that fly as one; made by `Connection.swarm`.

    Args:
        vehicles: The vehicles, the leader first.
        options: How they fly; None: the defaults.
    """

    def __init__(self, vehicles: Iterable[Vehicle], options: SwarmOptions | None = None) -> None:
        self._vehicles = tuple(vehicles)
        if not self._vehicles:
            raise InvalidArgumentError("a swarm must have at least one vehicle")
        self._options = options or SwarmOptions()
        self._controller: SwarmController | None = None
        self._loop: asyncio.Task[None] | None = None
        self._fleet: Fleet | None = None
        self._course = 0.0
        #: True while the call that runs follows a leader, on the way to the formation too.
        self._follows = False
        self._origin: LocalFrame | None = None

    async def __aenter__(self) -> Self:
        await asyncio.to_thread(import_libraries)
        await self._call("requesting positions", self._request_positions)
        members = [Member(vehicle) for vehicle in self._vehicles]
        try:
            await asyncio.gather(*(member.enter() for member in members))
        except BaseException as error:
            await _leave(members, error)
            raise
        self._fleet = fleet = Fleet(members, self._frame())
        fleet.open()
        self._controller = controller = SwarmController(fleet, self._options)
        self._loop = asyncio.create_task(controller.run())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        controller, self._controller = self._running, None
        try:
            if self._loop is not None:
                self._loop.cancel()
                with suppress(asyncio.CancelledError):
                    await self._loop
        finally:
            if self._fleet is not None:
                self._fleet.close()
            await _leave(controller.members, error)

    @property
    def vehicles(self) -> tuple[Vehicle, ...]:
        """The vehicles that follow the swarm's setpoints now, the leader first."""
        return tuple(member.vehicle for member in self._running.active)

    @property
    def smallest_separation(self) -> float:
        """The smallest distance of two vehicles so far in metres, heights divided by `VERTICAL_FACTOR`."""
        return self._running.guard.smallest_separation

    @property
    def places(self) -> Points:
        """The positions of `vehicles` in metres north, east, up of the ground below the leader's home."""
        return self._running.places()

    @property
    def paused(self) -> bool:
        """True if the call that runs is paused."""
        return self._running.pace.paused

    @property
    def progress(self) -> tuple[float, float]:
        """The seconds since the present course began, and those until its end; infinite if it has none."""
        return self._running.progress

    @property
    def course(self) -> float:
        """The direction of the formation in degrees."""
        return self._course

    @property
    def options(self) -> SwarmOptions:
        """How the vehicles fly."""
        return self._options

    async def formation(
        self,
        formation: str | Formation,
        *,
        spacing: float | None = None,
        course: float | None = None,
        altitude: float | None = None,
        **options: Any,  # noqa: ANN401 (those of Formation)
    ) -> None:
        """Fly into a formation, around the leader where it is.

        Args:
            formation: The name of a shape, or a formation.
            spacing: Metres between neighbours; None: `default_spacing`.
            course: Direction of the formation in degrees; None: the one that it has.
            altitude: Height of the leader in metres above its home; None: the one that it has.
            **options: `angle`, `rotation`, `layers`, `layer_spacing`, `text`, `points` of `Formation`.

        Raises:
            InvalidArgumentError: No transition keeps the planned distance, or a slot is lower than
                `LOWEST_SLOT`; no vehicle was moved.
            SwarmStopped: The guard or `stop` ended the flight.
        """
        check_numbers(course=course, altitude=altitude)
        members, starts = self._present()
        offsets = self._running.offsets(self._shape(formation, spacing, options), members)
        direction = self._course if course is None else course
        centre = starts[0] if altitude is None else np.array((starts[0, 0], starts[0, 1], altitude))
        slots = centre + rotate_to_course(offsets, direction)
        check_heights(slots, starts)
        plan = self._plan(starts, slots)
        self._course = direction
        await self._running.fly(plan, members)

    async def move(self, north: float = 0.0, east: float = 0.0, up: float = 0.0) -> None:
        """Move the whole swarm, each member by the same way.

        Args:
            north: Metres.
            east: Metres.
            up: Metres.

        Raises:
            SwarmStopped: The guard or `stop` ended the flight.
        """
        check_numbers(north=north, east=east, up=up)
        members, starts = self._present()
        ends = starts + np.array((north, east, up))
        await self._running.fly(straight_transition(starts, ends, self._options.limits), members)

    async def goto(self, latitude: float, longitude: float, altitude: float | None = None) -> None:
        """Move the whole swarm so that its leader arrives at a place.

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above the leader's home; None: the one that it has.

        Raises:
            SwarmStopped: The guard or `stop` ended the flight.
        """
        check_numbers(latitude=latitude, longitude=longitude, altitude=altitude)
        members, places = self._present()
        north, east, _ = self._frame().to_local(latitude, longitude, 0.0)
        position = members[0].vehicle.position
        now = None if position is None else position.relative_altitude
        climb = 0.0 if altitude is None or now is None else altitude - now
        await self.move(north - float(places[0, 0]), east - float(places[0, 1]), climb)

    async def rotate(self, degrees: float) -> None:
        """Turn the whole formation around its leader.

        Args:
            degrees: Clockwise if positive.

        Raises:
            SwarmStopped: The guard or `stop` ended the flight.
        """
        check_numbers(degrees=degrees)
        members, places = self._present()
        centre = (float(places[0, 0]), float(places[0, 1]))
        self._course = (self._course + degrees) % 360.0
        await self._running.fly(Turn(places, centre, degrees, self._options.limits), members)

    async def follow(
        self,
        leader: Vehicle,
        formation: str | Formation = "wedge",
        *,
        spacing: float | None = None,
        duration: float | None = None,
        **options: Any,  # noqa: ANN401 (those of Formation)
    ) -> None:
        """Follow a vehicle that is not a member, which another program flies.

        Args:
            leader: The vehicle; slot 0 of the formation is its own.
            formation: The name of a shape, or a formation.
            spacing: Metres between neighbours; None: as in `formation`.
            duration: Seconds; None: until the task is cancelled.
            **options: Those of `Formation`.

        Raises:
            ContactLost: No position of the leader arrives.
            SwarmStopped: The guard or `stop` ended the flight.
        """
        if leader in self._vehicles:
            raise InvalidArgumentError(
                f"vehicle {leader.system} is a member, and cannot be followed by the swarm"
            )
        await self._request_positions(leader)
        target, (members, places) = Member(leader), self._present()
        offsets = self._running.offsets(self._shape(formation, spacing, options), members, leaders=1)
        speed, link_age = self._options.limits.speed, self._options.guard.link_age
        motion = LeaderFrame(self._course, turn_rate_for(offsets, speed / 2.0, speed))
        measure(target, motion, self._frame())
        now = leader.connection.now
        plan = self._plan(places, motion.slots(offsets, now())[0])

        async def flight() -> None:
            await self._running.fly(plan, members, others=[target])
            course = Following(motion, offsets[plan.slots], now())
            await self._running.fly(course, members, until=duration, others=[target])

        self._follows = True
        try:
            await fly_with_leader(flight(), target, motion, self._frame(), link_age)
        finally:
            self._follows = False
            self._running.stand()

    async def show(
        self, show: Show, *, origin: tuple[float, float] | None = None, orientation: float = 0.0
    ) -> None:
        """Fly a show: the part of it in which all its vehicles are in the air.

        The members fly to the first places of that part; who flies which trajectory is assigned so that ways
        are short. The show is checked first against the margins and limits of the options.

        Args:
            show: The show, with as many vehicles as the swarm has.
            origin: Latitude and longitude of the show's origin in degrees; None: so that the middle of the
                first places is where the middle of the swarm is.
            orientation: Direction of the show's x axis in degrees, clockwise from north.

        Raises:
            InvalidArgumentError: The show has another number of vehicles, or passes a limit, or no transition
                to its begin keeps the planned distance; no vehicle was moved.
            SwarmStopped: The guard or `stop` ended the flight.
        """
        check_numbers(orientation=orientation)
        members, starts = self._present()
        limits = ShowLimits(self._options.margins.planned_distance, self._options.limits, math.inf, math.inf)
        await asyncio.to_thread(check_show_of, show, len(members), limits)
        first, last = show.airborne(LOWEST_SLOT)
        slots = placed(show.positions(first), orientation)
        shift = np.append((starts - slots)[:, :2].mean(axis=0), 0.0)
        if origin is not None:
            north, east, _ = self._frame().to_local(*origin, 0.0)
            shift = np.array((north, east, 0.0))
        plan = self._plan(starts, slots + shift)
        await self._running.fly(plan, members)
        place = (float(shift[0]), float(shift[1]), 0.0)
        course = ShowCourse(show, first, last, place, orientation, plan.slots.tolist())
        await self._running.fly(course, members)

    async def land(self) -> None:
        """Land all members where they are, and end the swarm's setpoints.

        Raises:
            GroupError: A vehicle did not land.
        """
        await self._call("landing", lambda vehicle: vehicle.land())

    def stop(self, reason: str = "stopped by the program") -> None:
        """Let all members stay where they are; the call that waits ends in `SwarmStopped`.

        Args:
            reason: The reason, a sentence.
        """
        self._running.stop(reason)

    def pause(self) -> None:
        """Let all members stop on their ways, and wait; the call that runs does not end.

        The time of the course slows down, so members keep their ways and the distances of the plan.

        Raises:
            InvalidArgumentError: The swarm follows a leader, which does not wait, or no course has begun: a
                call checks its plan first.
        """
        if self._follows:
            raise InvalidArgumentError("a swarm that follows a leader cannot pause: stop it")
        if self._running.progress[1] == 0.0:
            raise InvalidArgumentError("the swarm is on no way that it could pause on: stop it, or try again")
        self._running.pace.paused = True

    def resume(self) -> None:
        """Continue the call that was paused."""
        self._running.pace.paused = False

    @property
    def _running(self) -> SwarmController:
        if self._controller is None:
            raise InvalidArgumentError("the swarm is not running: use `async with`")
        return self._controller

    def _present(self) -> tuple[list[Member], Points]:
        """Return the members that follow setpoints, at least one, and their positions."""
        members = self._running.active
        if not members:
            raise SwarmStopped("no member follows setpoints any more", ())
        return members, self._running.places()

    def _shape(self, formation: str | Formation, spacing: float | None, options: dict[str, Any]) -> Formation:
        if isinstance(formation, Formation):
            return formation
        if spacing is None:
            spacing = default_spacing(formation, self._options.margins.planned_distance)
        return Formation(formation, spacing=spacing, **options)

    def _plan(self, starts: Points, slots: Points) -> Transition:
        margins = self._options.margins
        return plan_transition(
            starts,
            slots,
            margins.planned_distance,
            limits=self._options.limits,
            closest_start=margins.minimum,
        )

    def _frame(self) -> LocalFrame:
        """Return the frame of the swarm: its origin is on the ground below the leader's home."""
        if self._origin is None:
            leader = self._vehicles[0]
            home = leader.latest(common.GlobalPositionInt)
            if home is None:
                raise ContactLost("flying in a swarm with", str(leader.address), answer="no position arrived")
            altitude = (home.alt - home.relative_alt) / 1e3
            self._origin = LocalFrame(home.lat / 1e7, home.lon / 1e7, altitude)
        return self._origin

    async def _request_positions(self, vehicle: Vehicle) -> None:
        await vehicle.set_message_rate(common.GlobalPositionInt, RATE)
        await vehicle.wait_for_message(common.GlobalPositionInt)

    async def _call(self, name: str, work: Callable[[Vehicle], Awaitable[None]]) -> None:
        """Run a function for each vehicle; raises GroupError with the errors of all."""
        outcomes = await asyncio.gather(*map(work, self._vehicles), return_exceptions=True)
        ended = zip(self._vehicles, outcomes, strict=True)
        errors = {each.system: outcome for each, outcome in ended if isinstance(outcome, Exception)}
        if errors:
            raise GroupError(name, errors, len(outcomes))


async def _leave(members: Iterable[Member], ended_by: BaseException | None) -> None:
    """Let all members hold; what one refuses keeps no other from it, and replaces no other error."""
    leaving = (member.leave(ended_by) for member in members)
    outcomes = await asyncio.gather(*leaving, return_exceptions=True)
    ended = zip(members, outcomes, strict=False)
    errors = {each.vehicle.system: outcome for each, outcome in ended if isinstance(outcome, Exception)}
    if errors and ended_by is None:
        raise GroupError("holding after the swarm", errors, len(outcomes))
