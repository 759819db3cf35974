"""The session of the shell (connection, selected vehicle, settings, aliases) and the commands that act on it.

A session does not depend on a terminal. It prints the output of commands; `notifications` prints events.
"""

from __future__ import annotations

from contextlib import AsyncExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.output import echo
from mavstack.cli.common.selection import of_vehicle, systems_text
from mavstack.cli.shell.overrides import Overrides
from mavstack.cli.shell.settings import Settings
from mavstack.node.forwarding import Forwarding

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.cli.shell.reader import LineReader
    from mavstack.services.modes import AvailableMode
    from mavstack.vehicle import Connection, Vehicle

    Run: TypeAlias = Callable[["Session", list[str]], Awaitable[None]]
    #: Returns the completions of a word, from the session, the words before it and its typed part.
    Completer: TypeAlias = Callable[["Session", Sequence[str], str], Awaitable[Iterable[str]]]


@dataclass(frozen=True, slots=True)
class Command:
    """One command; `usage` follows its name in help texts, `run` raises a `MavstackError` if it fails."""

    name: str
    usage: str
    summary: str
    run: Run
    aliases: tuple[str, ...] = ()
    examples: tuple[str, ...] = ()
    details: str = ""
    #: True if the command needs a vehicle: a script waits for its vehicle before the command.
    needs_vehicle: bool = True
    complete: Completer | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The name and the aliases."""
        return (self.name, *self.aliases)

    @property
    def synopsis(self) -> str:
        """The name with the usage."""
        return f"{self.name} {self.usage}".rstrip()


class Session:
    """One user of one connection; an asynchronous context manager."""

    def __init__(self, connection: Connection, commands: Mapping[str, Command]) -> None:
        self.connection = connection
        #: Asks the user a question; None if the shell is not interactive.
        self.ask: Callable[[str], Awaitable[str]] | None = None
        #: The input line of the user; None if the shell is not interactive.
        self.reader: LineReader | None = None
        #: Waits for the script's vehicle before the first command that needs it; None: the vehicle was found.
        self.wait_for_vehicle: Callable[[], Awaitable[None]] | None = None
        #: Commands by name; a command may have several names.
        self.commands = commands
        self.settings = Settings()
        #: Command lines by the alias that the user defined.
        self.aliases: dict[str, str] = {}
        #: True after the command `exit`.
        self.exiting = False
        #: Current nesting depth of scripts and aliases.
        self.depth = 0
        self.forwarding = Forwarding(connection)
        self.overrides = Overrides()
        #: Directory listings for completion: time and names by system id and directory.
        self.completion_cache: dict[tuple[int, str], tuple[float, tuple[str, ...]]] = {}
        #: Names of the modes that a vehicle has listed, by system id.
        self.listed_modes: dict[int, tuple[str, ...]] = {}
        self._system: int | None = None
        self._stack = AsyncExitStack()

    @property
    def interactive(self) -> bool:
        """True if the user can be asked questions."""
        return self.ask is not None

    @property
    def selected(self) -> Vehicle | None:
        """The selected vehicle, or the only one that is heard; None without any, and before a choice."""
        vehicles = self.connection.vehicles
        if self._system is not None:
            return vehicles.get(self._system)
        return next(iter(vehicles.values())) if len(vehicles) == 1 else None

    @property
    def has_selection(self) -> bool:
        """True if a vehicle was selected by its system id."""
        return self._system is not None

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle that a command acts on, from then on the selected one.

        Raises:
            CommandError: No vehicle is heard, or several are and none is selected.
        """
        vehicle = self.selected
        if vehicle is None and self.connection.vehicles:
            raise CommandError(self.choice_text())
        if vehicle is None:
            raise CommandError("no vehicle has been heard yet; `link` shows the traffic of each link")
        self._system = vehicle.system
        return vehicle

    def choice_text(self) -> str:
        """Return how to choose one of several vehicles."""
        heard = self.connection.vehicles
        return f"more than one vehicle is heard ({systems_text(heard)}); `vehicle {min(heard)}` selects one"

    async def require_vehicle(self) -> None:
        """Wait for the vehicle of a script, once."""
        if self.wait_for_vehicle is not None:
            await self.wait_for_vehicle()
            self.wait_for_vehicle = None

    def select(self, system: int) -> Vehicle:
        """Select a vehicle by its system id.

        Raises:
            CommandError: No vehicle with this system id has been heard.
        """
        vehicle = self.connection.vehicles.get(system)
        if vehicle is None:
            known = ", ".join(map(str, self.connection.vehicles)) or "none"
            raise CommandError(f"no vehicle has the system id {system}; known: {known}")
        self._system = system
        return vehicle

    async def list_modes(self, vehicle: Vehicle) -> Sequence[AvailableMode]:
        """List the modes of a vehicle, and keep their names for completion."""
        found = await vehicle.modes.list()
        self.listed_modes[vehicle.system] = tuple(mode.name for mode in found)
        return found

    async def confirm(self, question: str) -> bool:
        """Ask the user a yes-or-no question; a shell that is not interactive answers no."""
        if self.ask is None:
            return False
        return (await self.ask(f"{question} [y/N] ")).strip().lower() in ("y", "yes")

    def print(self, *lines: str) -> None:
        """Print the output of a command."""
        echo(*lines)

    def report(self, text: str) -> None:
        """Print the outcome of a command; if several vehicles are heard, it names the vehicle."""
        self.print(of_vehicle(self.vehicle, text) if len(self.connection.vehicles) > 1 else text)

    async def __aenter__(self) -> Self:
        await self._stack.enter_async_context(self.forwarding)
        self._stack.push_async_callback(self.overrides.close)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._stack.aclose()
