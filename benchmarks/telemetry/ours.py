"""Mavstack: a callback for each packet, or an `async for` over the messages."""

from __future__ import annotations

import asyncio
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from mavstack import connect
from mavstack.dialects import Dialect
from mavstack.vehicle import VehicleLost, VehicleReturned

from .child import FIELDS, MessageRecorder, serve

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.node import Subscription
    from mavstack.vehicle import Connection
    from mavstack.wire import Packet


#: Seconds between two looks at the position.
READ_INTERVAL = 0.1


def _getters() -> dict[type[Message], Callable[[Any], object]]:
    dialect = Dialect.load("all")
    return {dialect[name]: attrgetter(*fields) for name, fields in FIELDS.items()}


async def _by_callback(recorder: MessageRecorder) -> None:
    """Receive by a packet listener."""
    getters = _getters()
    record = recorder.record

    def callback(packet: Packet) -> None:
        message = packet.message
        read = getters.get(type(message))
        if read is not None:
            read(message)
        record(packet.message_id)

    async with connect(f"udpin://127.0.0.1:{recorder.port}") as connection:
        await connection.wait_for_vehicle()
        connection.add_packet_listener(None, callback)
        await connection.serve_forever()


async def _by_iteration(recorder: MessageRecorder) -> None:
    """Receive by a task that iterates over a subscription."""
    getters = _getters()
    async with connect(f"udpin://127.0.0.1:{recorder.port}") as connection:
        await connection.wait_for_vehicle()
        messages: Subscription[Message] = connection.stream(keep_all=True)
        async for message in messages:
            read = getters.get(type(message))
            if read is not None:
                read(message)
            recorder.record(type(message).__mavlink_row__[0])


async def _by_reading(recorder: MessageRecorder) -> None:
    """Read the position ten times a second, and wait for events of vehicles; other messages are not taken."""
    async with connect(f"udpin://127.0.0.1:{recorder.port}") as connection:
        vehicle = await connection.wait_for_vehicle()
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(_follow(connection))
            while True:
                await asyncio.sleep(READ_INTERVAL)
                if vehicle.position is not None:
                    recorder.record()


async def _follow(connection: Connection) -> None:
    """Handle the events of vehicles, of which there are none during the measurement."""
    async with connection.events(VehicleLost, VehicleReturned) as events:
        async for event in events:
            print(event)


if __name__ == "__main__":
    serve(
        {
            "called": lambda recorder: asyncio.run(_by_callback(recorder)),
            "read": lambda recorder: asyncio.run(_by_reading(recorder)),
            "iterated": lambda recorder: asyncio.run(_by_iteration(recorder)),
        }
    )
