"""Another component, and what can be asked of it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.services.command import Command, CommandClient, CommandOperation, CommandResult

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.node import Node
    from mavstack.services import Address
    from mavstack.services.heartbeat import ComponentInfo


class RemoteComponent:
    """A component of another system; made by `Node.remote`, `Node.autopilot` or `Node.find`."""

    def __init__(self, node: Node, address: Address) -> None:
        self.node = node
        self.address = address

    @property
    def info(self) -> ComponentInfo | None:
        """What its heartbeat said; None if it was never heard."""
        return self.node.components.get(self.address)

    @cached_property
    def command_client(self) -> CommandClient:
        """The client that all its commands go through."""
        return self.node.serve(CommandClient(self.node.address, self.address))

    async def command(
        self,
        command: int,
        *params: float,
        frame: int | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> CommandResult:
        """Send a MAV_CMD with up to seven parameters until it is answered.

        With a `frame` it goes as COMMAND_INT, params 5 and 6 in degrees or metres. Raises `CommandDenied` or
        `CommandTimeout`. `progress` is called with percent and 100 while a long command runs.
        """
        asked = Command.of(command, params, frame)
        return await self.node.perform(self.command_client, CommandOperation(asked, limit=timeout), progress)

    def __repr__(self) -> str:
        return f"<RemoteComponent {self.address}>"
