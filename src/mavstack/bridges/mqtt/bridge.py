"""The bridge to MQTT: a session with the broker for each vehicle, so that each has its last will."""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.bridge import DEFAULT_NAME
from mavstack.bridges.core.following import follow_vehicles
from mavstack.bridges.mqtt.broker import Session
from mavstack.bridges.mqtt.vehicle_topics import MqttOptions, VehicleTopics
from mavstack.errors import LinkError

if TYPE_CHECKING:
    from collections.abc import Coroutine, Mapping
    from types import TracebackType
    from typing import Self

    from mavstack.vehicle import Connection, Vehicle

logger = logging.getLogger("mavstack.bridges")
#: Seconds between two attempts to connect for a vehicle that was found while the broker was unreachable.
RETRY_INTERVAL: Final = 10.0


class MqttBridge:
    """All vehicles of a connection on MQTT; an async context manager.

    Args:
        connection: The open connection.
        options: The options.
        names: The names of vehicles by system id; others are "uav" and their system id.
    """

    def __init__(
        self, connection: Connection, options: MqttOptions, names: Mapping[int, str] | None = None
    ) -> None:
        self._connection = connection
        self._options = options
        self._names = dict(names or {})
        self._tasks: set[asyncio.Task[None]] = set()
        #: The vehicles by system id.
        self.vehicles: dict[int, VehicleTopics] = {}

    async def open(self) -> Self:
        """Connect with the broker, and follow the vehicles.

        Returns:
            The bridge.

        Raises:
            LinkError: The broker does not answer, or refuses.
        """
        probe = Session(self._options.broker)
        await probe.open()
        await probe.close()
        for vehicle in self._connection.vehicles.values():
            self._add(vehicle)
        self._start(follow_vehicles(self._connection, self._add, self.vehicles))
        return self

    async def close(self) -> None:
        """Publish that all vehicles are offline, and disconnect. Idempotent."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await asyncio.gather(*(vehicle.close() for vehicle in self.vehicles.values()))
        if self.dropped:
            logger.warning("%d messages were dropped because the broker took none", self.dropped)
        self.vehicles.clear()

    @property
    def dropped(self) -> int:
        """The number of messages that were dropped because the broker took none."""
        return sum(vehicle.session.dropped for vehicle in self.vehicles.values())

    def _add(self, vehicle: Vehicle) -> None:
        if vehicle.system in self.vehicles:
            return
        name = self._names.get(vehicle.system, f"{DEFAULT_NAME}{vehicle.system}")
        added = self.vehicles[vehicle.system] = VehicleTopics(vehicle, name.strip("/"), self._options)
        self._start(_open(added))

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()


async def _open(vehicle: VehicleTopics) -> None:
    """Connect for a vehicle, until the broker accepts."""
    while True:
        try:
            await vehicle.open()
        except LinkError as error:
            logger.warning("%s is not on MQTT: %s", vehicle.name, error)
            await asyncio.sleep(RETRY_INTERVAL)
        else:
            logger.info("%s is on MQTT", vehicle.name)
            return
