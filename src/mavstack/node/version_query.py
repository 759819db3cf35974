"""Questions to autopilots that have only been heard speaking MAVLink 1, whether they can speak MAVLink 2.

With `version="auto"` the node answers such a peer in version 1. PX4 begins so on many ports and waits for a
packet of version 2, so both sides would stay there. The node therefore asks for AUTOPILOT_VERSION, which
either version can carry; its channel (see `channel_state`) switches when the capability MAVLINK2 arrives.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING

from mavstack.errors import MavstackError
from mavstack.services.heartbeat import ComponentFound, ComponentRebooted, ComponentReturned

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.channel_state import ChannelState
    from mavstack.node.component import RemoteComponent
    from mavstack.node.routes import Routes
    from mavstack.services import Address

_logger = logging.getLogger("mavstack.node")


class VersionQueries:
    """The questions of one node; they run in tasks of their own."""

    def __init__(self, routes: Routes[ChannelState], component: Callable[..., RemoteComponent]) -> None:
        self._routes = routes
        self._component = component
        self._tasks: dict[Address, asyncio.Task[None]] = {}

    def on_event(self, event: object) -> None:
        """Ask an autopilot that appeared, if its channel sends MAVLink 1 because of it."""
        match event:
            case ComponentFound(info) | ComponentReturned(info) | ComponentRebooted(info):
                if info.is_autopilot and self._speaks_version_1(info.address):
                    self._start(info.address)

    async def close(self) -> None:
        """Cancel the questions that are not answered yet."""
        tasks = tuple(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def _start(self, address: Address) -> None:
        if address not in self._tasks:
            task = asyncio.get_running_loop().create_task(self._ask(address))
            self._tasks[address] = task
            task.add_done_callback(lambda _: self._tasks.pop(address, None))

    def _speaks_version_1(self, address: Address) -> bool:
        return any(channel.negotiates and channel.version == 1 for channel in self._routes.heard_on(address))

    async def _ask(self, address: Address) -> None:
        try:
            await self._component(*address).get_version()
        except MavstackError as error:
            _logger.debug("MAVLink 1 is kept for %s: %s", address, error)
