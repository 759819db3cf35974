"""What the commands of the shell work on: the connection, the vehicle that is meant, settings and aliases.

A session knows nothing of a terminal. What a command tells it prints; what happens meanwhile is `news`.
"""

from __future__ import annotations

import sys
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING

from mavstack.cli.common.errors import CommandError
from mavstack.cli.shell.overrides import Overrides
from mavstack.cli.shell.settings import Settings
from mavstack.errors import MavstackError
from mavstack.node.forwarding import Forwarding

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping
    from types import TracebackType
    from typing import Self

    from mavstack.cli.shell.console_command import Command
    from mavstack.vehicle import Connection, Vehicle


class Session:
    """One user at one connection; enter it as long as it lasts."""

    def __init__(self, node: Connection, commands: Mapping[str, Command]) -> None:
        self.node = node
        #: Asks the user a question; None if nobody is there.
        self.ask: Callable[[str], Awaitable[str]] | None = None
        #: Every command, by each of its names.
        self.commands = commands
        self.settings = Settings()
        #: What the user calls lines of commands.
        self.aliases: dict[str, str] = {}
        #: Whether the user is done.
        self.leaving = False
        #: How deep scripts and aliases run in each other.
        self.depth = 0
        self.forwarding = Forwarding(node)
        self.overrides = Overrides()
        #: What completion found on the vehicle, and when.
        self.remembered: dict[tuple[int, str], tuple[float, tuple[str, ...]]] = {}
        self._system: int | None = None
        self._stack = AsyncExitStack()

    @property
    def interactive(self) -> bool:
        """Whether somebody can be asked."""
        return self.ask is not None

    @property
    def chosen(self) -> Vehicle | None:
        """The vehicle that is meant, if there is one: the one that was chosen, else the first."""
        if self._system is not None:
            return self.node.vehicles.get(self._system)
        return next(iter(self.node.vehicles.values()), None)

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle that is meant; raises `MavstackError` if there is none."""
        vehicle = self.chosen
        if vehicle is None:
            raise CommandError("no vehicle has been heard yet; `link` shows what comes in")
        return vehicle

    def choose(self, system: int) -> Vehicle:
        """Mean another vehicle from now on."""
        vehicle = self.node.vehicles.get(system)
        if vehicle is None:
            known = ", ".join(map(str, self.node.vehicles)) or "none"
            raise CommandError(f"no vehicle has the system id {system}; those heard: {known}")
        self._system = system
        return vehicle

    async def confirm(self, question: str) -> bool:
        """Ask the user; nobody there means no."""
        if self.ask is None:
            return False
        return (await self.ask(f"{question} [y/N] ")).strip().lower() in ("y", "yes")

    def say(self, *lines: str) -> None:
        """Tell what was asked for."""
        for line in lines:
            print(line)
        sys.stdout.flush()

    async def __aenter__(self) -> Self:
        await self._stack.enter_async_context(self.forwarding)
        self._stack.push_async_callback(self.overrides.close)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._stack.aclose()
