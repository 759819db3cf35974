"""The vehicles that a command acts on, and the outcome of each in one line.

For one vehicle a failure ends the command with one line on stderr. Several vehicles act at the same time;
each outcome is printed when it is known, and the exit code is 0 only if all succeeded.
"""

from __future__ import annotations

import asyncio
from argparse import ArgumentTypeError
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.connection import run_on_connection
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.vehicle.flight_progress import FlightProgress
from mavstack.errors import MavstackError
from mavstack.vehicle import Group

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.cli.vehicle.flight_progress import Remaining
    from mavstack.vehicle import Connection, Vehicle

#: Seconds to wait for further vehicles after one was found: two heartbeats.
DISCOVERY_TIME: Final = 2.5
_MAX_SYSTEM = 255


def add_selection(parser: ArgumentParser) -> None:
    """Declare the options that select several vehicles."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--systems", type=system_ids, metavar="IDS", help="several vehicles by system id: 1,2,5-9"
    )
    group.add_argument("--all", action="store_true", help="all vehicles that are heard")


def system_ids(text: str) -> list[int]:
    """Parse system ids such as 1,2,5-9, for argparse."""
    found: dict[int, None] = {}
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        if not (_is_id(first) and (not dash or _is_id(last))):
            raise ArgumentTypeError(f"{text!r} is not a list of system ids such as 1,2,5-9")
        found.update(dict.fromkeys(range(int(first), int(last or first) + 1)))
    if not found:
        raise ArgumentTypeError(f"{text!r} is an empty range")
    return list(found)


def run_on_vehicles(
    arguments: Namespace,
    work: Callable[[Vehicle], Awaitable[str]],
    remaining: Remaining | None = None,
) -> int:
    """Run `work` on the selected vehicles; it returns the text of a success."""

    async def run_selected(connection: Connection) -> int:
        group = await selected_vehicles(connection, arguments)
        if not selects_several(arguments):
            return await _run_on_one(next(iter(group)), arguments, work, remaining)
        outcomes = await group.each(lambda vehicle: _run_in_group(vehicle, arguments, work))
        expected = sum(isinstance(error, MavstackError) for error in outcomes.errors.values())
        if len(outcomes.errors) > expected:
            outcomes.check()  # raises a defect
        return 1 if outcomes.errors else 0

    return run_on_connection(arguments, run_selected)


def selects_several(arguments: Namespace) -> bool:
    """Return whether several vehicles are selected."""
    return bool(arguments.all or arguments.systems)


async def selected_vehicles(connection: Connection, arguments: Namespace) -> Group:
    """Wait for the selected vehicles.

    Raises:
        RemoteTimeout: A vehicle is not heard in time.
    """
    timeout = arguments.timeout
    if arguments.systems:
        waiting = [connection.wait_for_vehicle(system, timeout=timeout) for system in arguments.systems]
        return Group(await asyncio.gather(*waiting))
    first = await connection.wait_for_vehicle(arguments.system, timeout=timeout)
    if not arguments.all:
        return Group([first])
    known = 0
    while len(connection.vehicles) > known:
        known = len(connection.vehicles)
        await asyncio.sleep(DISCOVERY_TIME)
    return Group(sorted(connection.vehicles.values(), key=lambda vehicle: vehicle.system))


def report(arguments: Namespace, vehicle: Vehicle, text: str, error: Exception | None = None) -> None:
    """Print the outcome of a vehicle."""
    if arguments.json:
        outcome: dict[str, Any] = {"system": vehicle.system, "action": arguments.action, "ok": error is None}
        outcome["text" if error is None else "error"] = text
        echo_json(outcome)
    elif error is None:
        echo(f"vehicle {vehicle.system}: {text}")
    else:
        echo(f"mav vehicle: vehicle {vehicle.system}: {' '.join(text.split())}", error=True)


async def _run_on_one(
    vehicle: Vehicle,
    arguments: Namespace,
    work: Callable[[Vehicle], Awaitable[str]],
    remaining: Remaining | None,
) -> int:
    try:
        async with FlightProgress(vehicle, arguments.action, remaining):
            text = await work(vehicle)
    except MavstackError as error:
        if arguments.json:
            report(arguments, vehicle, str(error), error)
        raise
    report(arguments, vehicle, text)
    return 0


async def _run_in_group(
    vehicle: Vehicle, arguments: Namespace, work: Callable[[Vehicle], Awaitable[str]]
) -> None:
    try:
        text = await work(vehicle)
    except MavstackError as error:
        report(arguments, vehicle, str(error), error)
        raise
    report(arguments, vehicle, text)


def _is_id(text: str) -> bool:
    return text.isascii() and text.isdecimal() and 0 < int(text) <= _MAX_SYSTEM
