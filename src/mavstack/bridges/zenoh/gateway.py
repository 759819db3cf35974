"""The gateway: all vehicles of a connection on Zenoh.

    async with connect(url) as connection, Gateway(connection, Bus(options, "tower")) as gateway: …

Nothing from Zenoh reaches a vehicle unless the role of the gateway allows it. If two gateways serve vehicles
of one name, neither passes anything on: a command would be carried out twice, or by the wrong vehicle.
"""

from __future__ import annotations

import asyncio
import logging
from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.zenoh.fleet_vehicle import FleetVehicle
from mavstack.bridges.zenoh.keys import (
    DEFAULT_NAME,
    DEFAULT_PREFIX,
    VehicleKeys,
    checked_name,
    checked_prefix,
    gateway_key,
    parse_alive,
)
from mavstack.security.roles import Role
from mavstack.vehicle import VehicleFound, VehicleLost, VehicleReturned

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import TracebackType
    from typing import Self

    from mavstack.bridges.zenoh.bus import Bus
    from mavstack.vehicle import Connection, Vehicle

logger = logging.getLogger("mavstack.bridges")
#: Seconds for which a packet waits for others before they are sent as one sample; 0: only packets that were
#: read together form a sample.
BATCH_TIME: Final = 0.0
#: Hertz at which states that changed are published.
STATE_RATE: Final = 1.0
#: Of a vehicle without a subscriber to its states, one interval in this many publishes them.
UNWATCHED_DIVISOR: Final = 5
#: Maximum number of groups into which the vehicles are divided to publish their states one group at a time.
STATE_PARTS: Final = 25


@dataclass(frozen=True, slots=True)
class GatewayOptions:
    """The options of a gateway.

    Attributes:
        prefix: The prefix of all keys.
        names: The names of vehicles by system id; others are "sys" and their system id.
        role: The role of the bus.
        batch_time: Seconds that packets wait for others of the same sample; 0: for those of the same read.
        state_rate: Hertz at which states that changed are published; a fifth of it without a subscriber.
    """

    prefix: str = DEFAULT_PREFIX
    names: Mapping[int, str] = field(default_factory=dict)
    role: Role = Role.OBSERVE
    batch_time: float = BATCH_TIME
    state_rate: float = STATE_RATE


class Gateway:
    """All vehicles of a connection on Zenoh; an async context manager.

    Args:
        connection: The open connection.
        bus: The session, not open yet.
        options: What it does.
        report: Called with a line about each vehicle that was found.

    Raises:
        InvalidArgumentError: A name cannot be part of a key.
    """

    def __init__(
        self,
        connection: Connection,
        bus: Bus,
        options: GatewayOptions | None = None,
        report: Callable[[str], None] = logger.info,
    ) -> None:
        self.options = options or GatewayOptions()
        self._prefix = checked_prefix(self.options.prefix)
        self._names = {system: checked_name(name, "a name") for system, name in self.options.names.items()}
        self._connection = connection
        self._bus = bus
        self._report = report
        self._tasks: list[asyncio.Task[None]] = []
        self._kept: list[Any] = []
        self._waiting: list[FleetVehicle] = []
        self._alive: set[tuple[str, str]] = set()
        #: The vehicles on Zenoh, by system id.
        self.vehicles: dict[int, FleetVehicle] = {}

    async def open(self) -> Self:
        """Connect, and follow the vehicles.

        Returns:
            The gateway.

        Raises:
            LinkError: No router answers.
        """
        await self._bus.open()
        self._kept.append(self._bus.token(gateway_key(self._prefix, self._bus.gateway)))
        everywhere = VehicleKeys(self._prefix, "*").alive("*")
        self._kept.append(self._bus.liveliness(everywhere, self._on_token))
        for vehicle in self._connection.vehicles.values():
            self._add(vehicle)
        loop = asyncio.get_running_loop()
        self._tasks = [loop.create_task(self._follow()), loop.create_task(self._publish_states())]
        return self

    async def close(self) -> None:
        """Withdraw everything, and disconnect. Idempotent."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._tasks.clear()
        for vehicle in self.vehicles.values():
            await vehicle.close()
        self.vehicles.clear()
        self._kept.clear()
        await self._bus.close()

    def _add(self, vehicle: Vehicle) -> None:
        if vehicle.system in self.vehicles:
            return
        name = self._names.get(vehicle.system, f"{DEFAULT_NAME}{vehicle.system}")
        keys = VehicleKeys(self._prefix, name)
        added = FleetVehicle(vehicle, keys, self._bus, self.options.role, self._begin_batch)
        self.vehicles[vehicle.system] = added
        added.open()
        self._update_rivals(added)
        self._report(f"vehicle {vehicle.system} is {keys.root}")

    async def _follow(self) -> None:
        async with self._connection.events(VehicleFound, VehicleLost, VehicleReturned) as events:
            async for event in events:
                if isinstance(event, VehicleFound):
                    self._add(event.vehicle)
                elif (known := self.vehicles.get(event.vehicle.system)) is not None:
                    known.set_connected(connected=isinstance(event, VehicleReturned))

    async def _publish_states(self) -> None:
        """Publish all states in each interval, for a few vehicles at a time because packets wait."""
        for interval in count():
            vehicles = tuple(self.vehicles.values())
            parts = min(len(vehicles), STATE_PARTS) or 1
            for part in range(parts):
                await asyncio.sleep(1.0 / self.options.state_rate / parts)
                for vehicle in vehicles[part::parts]:
                    if vehicle.is_watched or (interval + vehicle.vehicle.system) % UNWATCHED_DIVISOR == 0:
                        vehicle.publish_states()

    # Batches

    def _begin_batch(self, vehicle: FleetVehicle) -> None:
        self._waiting.append(vehicle)
        if len(self._waiting) > 1:
            return
        loop = asyncio.get_running_loop()
        if self.options.batch_time > 0:
            loop.call_later(self.options.batch_time, self._flush)
        else:
            loop.call_soon(self._flush)

    def _flush(self) -> None:
        waiting, self._waiting = self._waiting, []
        for vehicle in waiting:
            vehicle.flush()

    # Other gateways

    def _on_token(self, key: str, exists: bool) -> None:
        found = parse_alive(self._prefix, key)
        if found is None or found[1] == self._bus.gateway:
            return
        (self._alive.add if exists else self._alive.discard)(found)
        for vehicle in self.vehicles.values():
            if vehicle.keys.name == found[0]:
                self._update_rivals(vehicle)

    def _update_rivals(self, vehicle: FleetVehicle) -> None:
        before = vehicle.rivals
        vehicle.rivals = {gateway for name, gateway in self._alive if name == vehicle.keys.name}
        if vehicle.rivals - before:
            logger.warning(
                "the gateway %s serves a vehicle named %s too: neither passes commands on until they have "
                "different names (--name)",
                ", ".join(sorted(vehicle.rivals)),
                vehicle.keys.name,
            )

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
