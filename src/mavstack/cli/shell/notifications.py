"""What happens meanwhile, told as it comes: texts of vehicles, vehicles that come and go, links that break.

It goes to stderr, so that what a script asks for can be piped; above the prompt on a terminal.
"""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import coloured
from mavstack.cli.common.text import printable
from mavstack.links import LinkDown
from mavstack.services.statustext import StatusText
from mavstack.vehicle import (
    GroundStationFound,
    GroundStationLost,
    OwnAddressConflict,
    SystemIdConflict,
    VehicleEvent,
    VehicleLost,
)

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.cli.shell.session import Session

_BAD: Final = (VehicleLost, SystemIdConflict, OwnAddressConflict)
_TOLD: Final = (VehicleEvent, GroundStationFound, GroundStationLost, OwnAddressConflict)
_ERASE: Final = "\r\x1b[K"
_COLOURS: Final = ("alarm", "alarm", "alarm", "red", "yellow", "cyan", "", "grey")


class News:
    """Tells what happens while a block lasts."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._events = session.node.events(StatusText, LinkDown, *_TOLD)
        self._task: asyncio.Task[None] | None = None

    def line(self, event: object) -> tuple[str, str] | None:
        """What is told of an event, and in which colour; None if nothing is."""
        match event:
            case StatusText(source=source, severity=severity, text=text):
                if severity > self._session.settings.severity or not self._is_ours(source.system):
                    return None
                several = len(self._session.node.vehicles) > 1
                known = min(max(severity, 0), len(_COLOURS) - 1)
                return f"{f'{source.system}: ' if several else ''}{printable(text)}", _COLOURS[known]
            case LinkDown(reason, retry_in):
                again = "" if retry_in == float("inf") else f"; tries again in {retry_in:.0f} s"
                return f"link down: {printable(reason)}{again}", "red"
            case _:
                return printable(str(event)), "red" if isinstance(event, _BAD) else "green"

    def _is_ours(self, system: int) -> bool:
        return system != self._session.node.address.system

    async def _tell(self) -> None:
        async for event in self._events:
            told = self.line(event)
            if told is not None:
                announce(*told)

    async def __aenter__(self) -> Self:
        self._task = asyncio.get_running_loop().create_task(self._tell())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._events.close()
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)


def announce(text: str, colour: str = "") -> None:
    """A line on stderr, in place of a progress line if there is one."""
    erase = _ERASE if sys.stderr.isatty() else ""
    print(f"{erase}{coloured(text, colour, sys.stderr)}", file=sys.stderr, flush=True)
