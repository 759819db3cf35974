"""The swarm of a station: at most one, which all clients see and move.

The first call that moves vehicles makes it, with the vehicles of the call. It lasts from call to call, so
that its guard watches the members all the time, until a call names other vehicles, the vehicles land, or a
client ends it. One call flies at a time: another one is refused, apart from those that stop.
"""

from __future__ import annotations

import asyncio
import math
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.swarm.separation import nearest_pair
from mavstack.vehicle import Group
from mavstack.vehicle.swarm import Swarm, SwarmOptions

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Sequence

    from mavstack.vehicle import Connection, Vehicle

Result = TypeVar("Result")


class StationSwarm:
    """The swarm of a station.

    Args:
        connection: The connection of the station.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._swarm: Swarm | None = None
        self._vehicles: tuple[Vehicle, ...] = ()
        #: The leader in the last call.
        self._led: Vehicle | None = None
        self._action: str | None = None
        self._flight: asyncio.Task[Any] | None = None
        #: The reason why the last call ended without a result; None if it has a result.
        self._reason: str | None = None
        self._smallest = math.inf

    def select(self, systems: Sequence[int] | None, lead: int | None) -> list[Vehicle]:
        """Return vehicles, the leader first.

        Args:
            systems: Their system ids; None: the members of the swarm, or all that are alive if there is
                none.
            lead: The system id of the leader; None: the one that leads or led last, or the first vehicle.

        Raises:
            RefusedError: A vehicle was not found, or there is none.
        """
        if systems is None and self._swarm is not None:
            if lead is None:
                return list(self._vehicles)
            systems = [each.system for each in self._vehicles]
        known = self._connection.vehicles
        wanted = sorted(known) if systems is None else list(dict.fromkeys(systems))
        if missing := [each for each in (*wanted, *([] if lead is None else [lead])) if each not in known]:
            raise RefusedError(404, f"no vehicle with system id {missing[0]} was found")
        chosen = [known[each] for each in wanted if systems is not None or known[each].alive]
        leader = self._leader if lead is None else known[lead]
        if leader is not None and (lead is not None or leader in chosen):
            chosen = [leader, *(each for each in chosen if each is not leader)]
        if not chosen:
            raise RefusedError(409, "no vehicle is alive: connect vehicles first")
        return chosen

    async def fly(
        self,
        action: str,
        vehicles: Sequence[Vehicle],
        work: Callable[[Swarm], Awaitable[None]],
        options: SwarmOptions | None = None,
    ) -> dict[str, Any]:
        """Fly a call of the swarm to its end.

        Args:
            action: Its name, such as "formation".
            vehicles: The members, the leader first.
            work: The call.
            options: How the members fly; None: the defaults.

        Returns:
            The state of the swarm.

        Raises:
            RefusedError: Another call flies.
            MavstackError: The errors of `Swarm`.
        """

        async def flight() -> None:
            self._led = vehicles[0]
            await work(await self._enter(vehicles, options or SwarmOptions()))

        await self.run(action, flight)
        return self.values()

    async def run(self, action: str, work: Callable[[], Awaitable[Result]]) -> Result:
        """Run a call, the only one at a time; raises `RefusedError` while another one runs."""
        if self._flight is not None and not self._flight.done():
            raise RefusedError(409, f"the swarm is busy ({self._action}): stop it first")
        self._action, self._reason = action, None
        flight = asyncio.ensure_future(work())
        self._flight = flight
        try:
            return await asyncio.shield(flight)
        except asyncio.CancelledError:
            if not flight.cancelled():  # the client cancelled its call
                flight.cancel()
                await asyncio.gather(flight, return_exceptions=True)
                self._reason = "cancelled by its client"
                raise
            self._reason = "stopped by a client"
            raise RefusedError(409, f"{action} was stopped by a client") from None
        except MavstackError as error:
            self._reason = str(error)
            raise
        finally:
            self._action = None

    async def take_off(
        self, vehicles: Sequence[Vehicle], work: Callable[[Group], Awaitable[None]]
    ) -> dict[str, Any]:
        """Let vehicles take off; they are no members before the next call.

        Args:
            vehicles: The vehicles.
            work: The takeoff of the group.
        """

        async def flight() -> None:
            self._led = vehicles[0]
            await work(Group(vehicles))

        await self.run("takeoff", flight)
        return self.values(vehicles)

    async def land(self, vehicles: Sequence[Vehicle]) -> dict[str, Any]:
        """End the swarm, and let its vehicles land; a running flight is stopped."""
        await self._interrupt()

        async def work() -> None:
            await self.end()
            (await Group(each for each in vehicles if each.in_air is not False).land()).check()

        await self.run("landing", work)
        return self.values(vehicles)

    async def stop(self, vehicles: Sequence[Vehicle]) -> dict[str, Any]:
        """Stop the running flight, end the swarm, and let armed vehicles hold where they are."""
        await self._interrupt()
        await self.end()
        moving = Group(each for each in vehicles if each.armed is not False)
        (await moving.hold()).check()
        self._reason = "stopped by a client"
        return self.values(vehicles)

    def pause(self, *, paused: bool) -> dict[str, Any]:
        """Let the running flight wait on its way, or continue.

        Args:
            paused: False: continue.

        Raises:
            RefusedError: No flight of the swarm runs.
            InvalidArgumentError: The swarm follows a leader.
        """
        swarm = self._swarm
        if swarm is None or self._action in (None, "takeoff", "landing"):
            raise RefusedError(409, "no flight of the swarm runs")
        if paused:
            swarm.pause()
        else:
            swarm.resume()
        return self.values()

    async def end(self) -> None:
        """End the swarm: each member holds where it is. Idempotent."""
        swarm, self._swarm = self._swarm, None
        if swarm is not None:
            self._smallest = min(self._smallest, swarm.smallest_separation)
            await swarm.__aexit__(None, None, None)

    async def close(self) -> None:
        """Stop the running flight, and end the swarm."""
        await self._interrupt()
        await self.end()

    def values(self, vehicles: Sequence[Vehicle] | None = None) -> dict[str, Any]:
        """Return the state as JSON.

        Args:
            vehicles: The vehicles of the call; None: those of the swarm.
        """
        swarm = self._swarm
        smallest = self._smallest if swarm is None else min(self._smallest, swarm.smallest_separation)
        places = None if swarm is None else swarm.places
        nearest, first, second = (math.inf, 0, 0) if places is None else nearest_pair(places)
        members = self._vehicles if vehicles is None else tuple(vehicles)
        active = () if swarm is None else swarm.vehicles
        leader = self._leader
        return {
            "active": swarm is not None,
            "action": self._action,
            "reason": self._reason,
            "paused": swarm is not None and swarm.paused,
            "leader": None if leader is None else leader.system,
            "systems": [each.system for each in members],
            "course_deg": None if swarm is None else round(swarm.course, 1),
            "separation_m": _metres(nearest),
            "nearest_pair": [active[first].system, active[second].system] if math.isfinite(nearest) else None,
            "smallest_separation_m": _metres(smallest),
            "limit_m": None if swarm is None else swarm.options.guard.separation,
            "members": [_member(each, each in active) for each in members],
        }

    @property
    def _leader(self) -> Vehicle | None:
        """The vehicle that leads; without a running swarm, the one that led in the last call."""
        active = () if self._swarm is None else self._swarm.vehicles
        return active[0] if active else self._led

    async def _enter(self, vehicles: Sequence[Vehicle], options: SwarmOptions) -> Swarm:
        """Return the running swarm of these vehicles; members that left it are entered again."""
        if self._swarm is not None:
            present = set(self._swarm.vehicles) == set(vehicles) and self._vehicles == tuple(vehicles)
            if present and self._swarm.options == options:
                return self._swarm
            await self.end()
        self._vehicles, self._smallest = tuple(vehicles), math.inf
        swarm = Swarm(vehicles, options)
        await swarm.__aenter__()
        self._swarm = swarm
        return swarm

    async def _interrupt(self) -> None:
        if self._flight is not None and not self._flight.done():
            self._flight.cancel()
            await asyncio.gather(self._flight, return_exceptions=True)


def _member(vehicle: Vehicle, follows: bool) -> dict[str, Any]:
    position = vehicle.position
    return {
        "system": vehicle.system,
        "follows": follows,
        "alive": vehicle.alive,
        "armed": vehicle.armed,
        "mode": vehicle.mode,
        "latitude": None if position is None else position.latitude,
        "longitude": None if position is None else position.longitude,
        "altitude_m": None if position is None else position.relative_altitude,
    }


def _metres(distance: float) -> float | None:
    return round(distance, 2) if math.isfinite(distance) else None
