"""Air traffic from a receiver to the vehicles of a connection, and alarms about close approaches.

    async with TrafficFeed(connection, "sbs://127.0.0.1:30003") as feed:
        async for alarm in feed.alarms(): ...

Each second every vehicle is shown the aircraft nearest to it, and with `fleet=True` the other vehicles of the
connection as aircraft too.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from math import atan2, degrees
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkURLError
from mavstack.links import BytesReceived, LinkDown, open_link
from mavstack.node.api_object import ApiObject
from mavstack.services.traffic import TrafficSender
from mavstack.traffic import Aircraft, AircraftTable, BeastReader, Gdl90Reader, SbsReader, closest_approach

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Mapping, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.links.events import LinkEvent
    from mavstack.traffic import Approach, Report
    from mavstack.vehicle.connection import Connection
    from mavstack.vehicle.vehicle import Vehicle

INTERVAL: Final = 1.0
#: The number of aircraft that are reported to each vehicle.
DEFAULT_COUNT: Final = 25
#: The largest distance of these aircraft, in metres.
DEFAULT_REACH: Final = 50_000.0
#: An approach within these distances in metres and this time in seconds is an alarm.
ALARM_HORIZONTAL: Final = 500.0
ALARM_VERTICAL: Final = 150.0
ALARM_TIME: Final = 60.0
#: Seconds between two alarms about the same pair.
ALARM_INTERVAL: Final = 10.0
#: The addresses of vehicles, which have no transponder, begin here; ICAO does not assign them.
_FLEET_ADDRESS: Final = 0xF00000
_PORTS: Final = {"sbs": 30003, "beast": 30005, "gdl90": 4000}
_READERS: Final[Mapping[str, type[SbsReader | BeastReader | Gdl90Reader]]] = MappingProxyType(
    {"sbs": SbsReader, "beast": BeastReader, "gdl90": Gdl90Reader}
)


@dataclass(frozen=True, slots=True)
class TrafficAlarm:
    """An aircraft that comes close to a vehicle.

    Attributes:
        system: The system id of the vehicle.
        aircraft: The aircraft.
        approach: Seconds until the closest approach, and the distances then in metres.
    """

    system: int
    aircraft: Aircraft
    approach: Approach


class TrafficFeed(ApiObject):
    """Traffic from a receiver to vehicles; an async context manager.

    Args:
        connection: The connection to the vehicles.
        url: `sbs://HOST:PORT`, `beast://HOST:PORT` (both TCP), or `gdl90://HOST:PORT` (UDP, listens).
        count: Aircraft that are shown to each vehicle.
        reach: The largest distance of an aircraft from a vehicle, metres.
        fleet: Show each vehicle the other vehicles of the connection too.

    Raises:
        LinkURLError: The URL is malformed.
    """

    def __init__(
        self,
        connection: Connection,
        url: str,
        *,
        count: int = DEFAULT_COUNT,
        reach: float = DEFAULT_REACH,
        fleet: bool = False,
    ) -> None:
        self._connection = connection
        scheme, separator, place = url.partition("://")
        if scheme not in _PORTS or not separator or not place:
            raise LinkURLError(f"a source of traffic is sbs://, beast:// or gdl90://HOST:PORT, got {url!r}")
        place = place if place.rpartition("]")[2].count(":") else f"{place}:{_PORTS[scheme]}"
        self._link = open_link(f"{'udpin' if scheme == 'gdl90' else 'tcpout'}://{place}")
        self._reader: SbsReader | BeastReader | Gdl90Reader = _READERS[scheme]()
        self._count, self._reach, self._fleet = count, reach, fleet
        #: The aircraft that the receiver reported.
        self.aircraft = AircraftTable()
        #: The number of reports that were received.
        self.reports = 0
        #: The reason for the last loss of the receiver; empty if there was none.
        self.problem = ""
        self._sender = TrafficSender(connection.address)
        self._alarms: asyncio.Queue[TrafficAlarm] = asyncio.Queue(1000)
        self._alarmed: dict[tuple[int, int], float] = {}
        self._tasks: list[asyncio.Task[None]] = []

    @property
    def sent(self) -> int:
        """The messages that were sent to vehicles."""
        return self._sender.sent

    async def __aenter__(self) -> Self:
        await self._link.open()
        self._connection.serve(self._sender)
        loop = asyncio.get_running_loop()
        self._tasks = [loop.create_task(self._link.read(self._receive)), loop.create_task(self._run())]
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self._link.close()
        self._connection._host.remove(self._sender)  # noqa: SLF001 (nodes have no call for it)

    async def alarms(self) -> AsyncIterator[TrafficAlarm]:
        """Yield the alarms, without end."""
        while True:
            yield await self._alarms.get()

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case BytesReceived(data=data):
                    for report in self._read(data):
                        self.reports += 1
                        self.aircraft.update(report, self._connection.now())
                case LinkDown(reason=reason):
                    self.problem = reason

    def _read(self, data: bytes) -> list[Report]:
        if isinstance(self._reader, BeastReader):
            return self._reader.feed(data, self._connection.now())
        return self._reader.feed(data)

    async def _run(self) -> None:
        while True:
            self._show(self._connection.now())
            await asyncio.sleep(INTERVAL)

    def _show(self, now: float) -> None:
        self.aircraft.forget_old(now)
        own = {system: _as_aircraft(each, now) for system, each in self._connection.vehicles.items()}
        shown: dict[int, Aircraft] = {}
        for system, vehicle in own.items():
            if vehicle is None or vehicle.latitude is None or vehicle.longitude is None:
                continue
            place = vehicle.latitude, vehicle.longitude
            near = self.aircraft.nearest(*place, now, count=self._count, reach=self._reach)
            others = [other for number, other in own.items() if number != system and other is not None]
            for aircraft in [each for _, each in near] + others * self._fleet:
                shown[aircraft.address] = aircraft
                self._check_approach(system, vehicle, aircraft, now)
        self._sender.show(shown.values(), now)
        self._connection.wake(self._sender)

    def _check_approach(self, system: int, vehicle: Aircraft, aircraft: Aircraft, now: float) -> None:
        """Raise an alarm about an approach, but not again for some seconds."""
        approach = closest_approach(vehicle, aircraft)
        if approach is None or approach.time > ALARM_TIME or approach.horizontal > ALARM_HORIZONTAL:
            return
        pair = system, aircraft.address
        if approach.vertical > ALARM_VERTICAL or now - self._alarmed.get(pair, 0.0) < ALARM_INTERVAL:
            return
        self._alarmed = {key: at for key, at in self._alarmed.items() if now - at < ALARM_INTERVAL}
        self._alarmed[pair] = now
        if not self._alarms.full():
            self._alarms.put_nowait(TrafficAlarm(system, aircraft, approach))


def _as_aircraft(vehicle: Vehicle, now: float) -> Aircraft | None:
    """Return a vehicle as an aircraft; None without a position."""
    position, velocity = vehicle.position, vehicle.velocity
    if position is None:
        return None
    return Aircraft(
        _FLEET_ADDRESS | vehicle.system,
        now,
        now,
        f"MAV{vehicle.system}",
        position.latitude,
        position.longitude,
        position.altitude,
        True,
        None if velocity is None else _course(velocity.north, velocity.east),
        None if velocity is None else velocity.ground_speed,
        None if velocity is None else -velocity.down,
    )


def _course(north: float, east: float) -> float:
    """Return the course of a velocity in degrees, 0 to 360."""
    return degrees(atan2(east, north)) % 360
