"""`mav vehicle events`: the events of vehicles as they arrive, with the words of their metadata."""

from __future__ import annotations

import asyncio
from datetime import datetime
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import on_vehicle
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import coloured, echo, echo_json
from mavstack.cli.common.selection import of_vehicle, selects_several
from mavstack.cli.vehicle.arguments import add_action
from mavstack.dialects import common
from mavstack.errors import RemoteError
from mavstack.services.events import LogLevel

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.cli.common.actions import Actions
    from mavstack.services.events import DecodedEvent
    from mavstack.vehicle import Vehicle

#: Seconds without an announcement of events, sent every three seconds, after which a vehicle has no events.
_ANNOUNCEMENT_TIMEOUT: Final = 8.0
#: Colours by severity.
_COLOURS: Final = ("alarm", "alarm", "alarm", "red", "yellow", "cyan")
_LEVELS: Final = tuple(level.name.lower() for level in LogLevel)


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    action: ArgumentParser = add_action(actions, "events", "print the events of a PX4 vehicle", show_events)
    action.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    action.add_argument(
        "--severity",
        choices=_LEVELS,
        default="debug",
        metavar="LEVEL",
        help="the least severe level to print: emergency, alert, critical, error, warning, notice, info, "
        "debug; protocol and disabled are for programs (default: debug)",
    )


@on_vehicle
async def show_events(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav vehicle events`."""
    hint = asyncio.get_running_loop().create_task(_hint_at_missing_events(vehicle))
    severity = LogLevel[arguments.severity.upper()]
    try:
        async with vehicle.events(severity=severity) as events, asyncio.timeout(arguments.duration):
            async for event in events:
                _show(vehicle, event, arguments)
    except TimeoutError as error:
        if isinstance(error, RemoteError):
            raise
        return 0
    finally:
        hint.cancel()
    return 1  # the events ended because the connection was closed


def _show(vehicle: Vehicle, event: DecodedEvent, arguments: Namespace) -> None:
    severity = getattr(event.severity, "name", str(event.severity)).lower()
    if arguments.json:
        echo_json(
            {
                "time": event.time,
                "system": vehicle.system,
                "component": event.source.component,
                "sequence": event.sequence,
                "id": event.id,
                "severity": severity,
                "name": event.name or None,
                "message": event.message,
                "description": event.description or None,
                "arguments": dict(event.arguments),
            }
        )
        return
    clock = f"{datetime.fromtimestamp(event.time).astimezone():%H:%M:%S}"
    colour = _COLOURS[event.severity] if event.severity < len(_COLOURS) else ""
    text = f"{clock} {severity:<9} {coloured(event.message, colour)}"
    echo(of_vehicle(vehicle, text) if selects_several(arguments) else text)


async def _hint_at_missing_events(vehicle: Vehicle) -> None:
    """Say on stderr if the vehicle has no events."""
    await asyncio.sleep(_ANNOUNCEMENT_TIMEOUT)
    if vehicle.latest(common.CurrentEventSequence) is None and vehicle.latest(common.Event) is None:
        text = of_vehicle(
            vehicle, "it sends no events; status texts are shown by `mav shell` and `mav watch`"
        )
        echo(f"mav vehicle: {text}", error=True)
