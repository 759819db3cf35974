"""Which vehicles a command is for, and a line for each about what became of it.

One vehicle is told as any command tells: what failed ends it, in one line on stderr. Several are asked at the
same time; each line is told as soon as it is known, and the exit code is 0 only if all did it.
"""

from __future__ import annotations

import asyncio
import json
import sys
from argparse import ArgumentTypeError
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.connection import run_on_connection
from mavstack.cli.vehicle.flight_progress import FlightProgress
from mavstack.errors import MavstackError
from mavstack.vehicle import Group

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.cli.vehicle.flight_progress import Left
    from mavstack.vehicle import Connection, Vehicle

#: After a vehicle was heard, how long to wait for more of them: two heartbeats.
SETTLING: Final = 2.5
_LAST = 255


def add_selection(parser: ArgumentParser) -> None:
    """Offer to mean several vehicles."""
    several = parser.add_mutually_exclusive_group()
    several.add_argument(
        "--systems", type=system_ids, metavar="IDS", help="several vehicles, by system id: 1,2,5-9"
    )
    several.add_argument("--all", action="store_true", help="all vehicles that are heard")


def system_ids(text: str) -> list[int]:
    """System ids, for argparse: 1,2,5-9."""
    found: dict[int, None] = {}
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        if not (_is_id(first) and (not dash or _is_id(last))):
            raise ArgumentTypeError(f"{text!r} names no system ids; a right one is 1,2,5-9")
        found.update(dict.fromkeys(range(int(first), int(last or first) + 1)))
    if not found:
        raise ArgumentTypeError(f"{text!r} is an empty range")
    return list(found)


def carry_out(
    arguments: Namespace,
    work: Callable[[Vehicle], Awaitable[str]],
    left: Left | None = None,
) -> int:
    """Have the chosen vehicles do it; `work` gives what to tell of one that did."""

    async def whole(node: Connection) -> int:
        group = await chosen(node, arguments)
        if not several(arguments):
            return await _one(next(iter(group)), arguments, work, left)
        outcomes = await group.each(lambda vehicle: _one_of_many(vehicle, arguments, work))
        outcomes_failed = sum(isinstance(error, MavstackError) for error in outcomes.errors.values())
        if len(outcomes.errors) > outcomes_failed:
            outcomes.check()  # a defect is raised
        return 1 if outcomes.errors else 0

    return run_on_connection(arguments, whole)


def several(arguments: Namespace) -> bool:
    """Whether several vehicles are meant."""
    return bool(arguments.all or arguments.systems)


async def chosen(node: Connection, arguments: Namespace) -> Group:
    """The vehicles that are meant; raises `RemoteTimeout` if one is not heard."""
    timeout = arguments.timeout
    if arguments.systems:
        waiting = [node.wait_for_vehicle(system, timeout=timeout) for system in arguments.systems]
        return Group(await asyncio.gather(*waiting))
    first = await node.wait_for_vehicle(arguments.system, timeout=timeout)
    if not arguments.all:
        return Group([first])
    known = 0
    while len(node.vehicles) > known:
        known = len(node.vehicles)
        await asyncio.sleep(SETTLING)
    return Group(sorted(node.vehicles.values(), key=lambda vehicle: vehicle.system))


def tell(arguments: Namespace, vehicle: Vehicle, text: str, error: Exception | None = None) -> None:
    """A line about what became of a vehicle."""
    if arguments.json:
        outcome: dict[str, Any] = {"system": vehicle.system, "action": arguments.action, "ok": error is None}
        outcome["text" if error is None else "error"] = text
        print(json.dumps(outcome), flush=True)
    elif error is None:
        print(f"vehicle {vehicle.system}: {text}", flush=True)
    else:
        print(f"mav vehicle: vehicle {vehicle.system}: {' '.join(text.split())}", file=sys.stderr, flush=True)


async def _one(
    vehicle: Vehicle,
    arguments: Namespace,
    work: Callable[[Vehicle], Awaitable[str]],
    left: Left | None,
) -> int:
    try:
        async with FlightProgress(vehicle, arguments.action, left):
            text = await work(vehicle)
    except MavstackError as error:
        if arguments.json:
            tell(arguments, vehicle, str(error), error)
        raise
    tell(arguments, vehicle, text)
    return 0


async def _one_of_many(
    vehicle: Vehicle, arguments: Namespace, work: Callable[[Vehicle], Awaitable[str]]
) -> None:
    try:
        text = await work(vehicle)
    except MavstackError as error:
        tell(arguments, vehicle, str(error), error)
        raise
    tell(arguments, vehicle, text)


def _is_id(text: str) -> bool:
    return text.isascii() and text.isdecimal() and 0 < int(text) <= _LAST
