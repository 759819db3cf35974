"""Mavstack: a function called with each packet, or an `async for` over the messages."""

from __future__ import annotations

import asyncio
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from mavstack import connect
from mavstack.dialects import Dialect

from .child import FIELDS, Ear, serve

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.node import Subscription
    from mavstack.wire import Packet


def _getters() -> dict[type[Message], Callable[[Any], object]]:
    dialect = Dialect.load("all")
    return {dialect[name]: attrgetter(*fields) for name, fields in FIELDS.items()}


async def _called(ear: Ear) -> None:
    """By the function that `listen` is given."""
    getters = _getters()
    hear = ear.hear

    def take(packet: Packet) -> None:
        message = packet.message
        read = getters.get(type(message))
        if read is not None:
            read(message)
        hear(packet.message_id)

    async with connect(f"udpin://127.0.0.1:{ear.port}") as node:
        await node.wait_for_vehicle()
        node.add_packet_listener(take)
        await node.serve_forever()


async def _iterated(ear: Ear) -> None:
    """By a task that reads a subscription."""
    getters = _getters()
    async with connect(f"udpin://127.0.0.1:{ear.port}") as node:
        await node.wait_for_vehicle()
        messages: Subscription[Message] = node.stream(keep_all=True)
        async for message in messages:
            read = getters.get(type(message))
            if read is not None:
                read(message)
            ear.hear(type(message).__mavlink_row__[0])


if __name__ == "__main__":
    serve(
        {"called": lambda ear: asyncio.run(_called(ear)), "iterated": lambda ear: asyncio.run(_iterated(ear))}
    )
