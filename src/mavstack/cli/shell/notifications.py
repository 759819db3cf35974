"""Notifications while the shell runs: status texts, events, vehicles found and lost, links that go down.

They are printed on stderr, so that the output of commands can be piped, and above the prompt on a terminal.
PX4 sends most events as status texts too: once the words of a component's events are known, the events are
printed, which arrive reliably, and not those texts.
"""

from __future__ import annotations

import asyncio
import sys
from collections import Counter
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import coloured, echo, echo_progress
from mavstack.cli.common.text import printable
from mavstack.links import LinkDown
from mavstack.services.events import DecodedEvent
from mavstack.services.statustext import StatusText
from mavstack.vehicle import (
    GroundStationFound,
    GroundStationLost,
    OwnAddressConflict,
    SystemIdConflict,
    VehicleEvent,
    VehicleFound,
    VehicleLost,
)

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.cli.shell.session import Session
    from mavstack.node import EventListener
    from mavstack.services import Address
    from mavstack.vehicle import Vehicle

_WARNINGS: Final = (VehicleLost, SystemIdConflict, OwnAddressConflict)
_EVENTS: Final = (VehicleEvent, GroundStationFound, GroundStationLost, OwnAddressConflict)
#: Colours of status texts by severity.
_COLOURS: Final = ("alarm", "alarm", "alarm", "red", "yellow", "cyan", "", "grey")


class Notifications:
    """Prints notifications while a block runs."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._events = session.connection.events(StatusText, LinkDown, *_EVENTS)
        self._task: asyncio.Task[None] | None = None
        self._listeners: dict[int, EventListener] = {}
        #: The components whose events are decoded and printed.
        self._decoded: set[Address] = set()
        #: The number of events that were printed already, as status texts, by component.
        self._printed: Counter[Address] = Counter()

    def line(self, event: object) -> tuple[str, str] | None:
        """Return text and colour of a notification; None for an event that is not shown."""
        match event:
            case StatusText(source=source) if source.system == self._own_system:
                return None
            case StatusText(source=source, has_event=True) if source in self._decoded:
                return None
            case StatusText(source=source, severity=severity, text=text):
                self._printed[source] += event.has_event
                return self._notice(source, severity, text)
            case DecodedEvent(source=source, severity=severity, message=text):
                if not event.is_known:
                    return None
                self._decoded.add(source)
                if self._printed[source]:
                    self._printed[source] -= 1
                    return None
                return self._notice(source, severity, text)
            case LinkDown(reason, retry_in):
                retry = "" if retry_in == float("inf") else f"; next try in {retry_in:.0f} s"
                return f"link down: {printable(reason)}{retry}", "red"
            case _:
                return printable(str(event)), "red" if isinstance(event, _WARNINGS) else "green"

    def _notice(self, source: Address, severity: int, text: str) -> tuple[str, str] | None:
        if severity > self._session.settings.severity:
            return None
        several = len(self._session.connection.vehicles) > 1
        known = min(max(severity, 0), len(_COLOURS) - 1)
        return f"{f'{source.system}: ' if several else ''}{printable(text)}", _COLOURS[known]

    @property
    def _own_system(self) -> int:
        return self._session.connection.address.system

    async def _print_events(self) -> None:
        async for event in self._events:
            if isinstance(event, VehicleFound):
                self._listen(event.vehicle)
            self._print(event)

    def _print(self, event: object) -> None:
        notification = self.line(event)
        if notification is not None:
            print_notification(*notification)

    def _listen(self, vehicle: Vehicle) -> None:
        if vehicle.system not in self._listeners:
            self._listeners[vehicle.system] = vehicle.add_event_listener(self._print)

    async def __aenter__(self) -> Self:
        for vehicle in self._session.connection.vehicles.values():
            self._listen(vehicle)
        self._task = asyncio.get_running_loop().create_task(self._print_events())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._events.close()
        for listener in self._listeners.values():
            listener.close()
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)


def print_notification(text: str, colour: str = "") -> None:
    """Print a line on stderr, over a progress line if there is one."""
    if sys.stderr.isatty():
        echo_progress("")
    echo(coloured(text, colour), error=True)
