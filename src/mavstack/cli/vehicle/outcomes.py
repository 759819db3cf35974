"""The actions of `mav vehicle` on the selected vehicles, and the outcome of each in one line.

For one vehicle a failure ends the command with one line on stderr. Several vehicles act at the same time;
each outcome is printed when it is known, and the exit code is 0 only if all succeeded.
"""

from __future__ import annotations

from contextlib import nullcontext
from functools import wraps
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.connection import run_on_connection
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import mention_conflict, of_vehicle, selected_vehicles, selects_several
from mavstack.cli.vehicle.flight_progress import flight_progress
from mavstack.cli.vehicle.interruption import notice_of_interruption
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable
    from contextlib import AbstractContextManager

    from mavstack.cli.vehicle.flight_progress import Remaining
    from mavstack.vehicle import Connection, Vehicle


def run_on_vehicles(
    arguments: Namespace, work: Callable[[Vehicle], Awaitable[str]], remaining: Remaining | None = None
) -> int:
    """Run `work` on the selected vehicles, or on that of a session; it returns the text of a success."""
    session_work = getattr(arguments, "session_work", None)
    if session_work is not None:
        session_work(lambda vehicle: _run_on_one(vehicle, arguments, work, remaining))
        return 0

    async def run_selected(connection: Connection) -> int:
        group = await selected_vehicles(connection, arguments)
        if not selects_several(arguments):
            vehicle = next(iter(group))
            code = await _run_on_one(vehicle, arguments, work, remaining)
            await mention_conflict(vehicle, arguments)
            return code
        outcomes = await group.each(lambda vehicle: _run_in_group(vehicle, arguments, work))
        expected = sum(isinstance(error, MavstackError) for error in outcomes.errors.values())
        if len(outcomes.errors) > expected:
            outcomes.check()  # raise an error that is not a `MavstackError`: a defect of the program
        return 1 if outcomes.errors else 0

    return run_on_connection(arguments, run_selected)


def on_vehicles(work: Callable[[Vehicle, Namespace], Awaitable[str]]) -> Callable[[Namespace], int]:
    """Return the function of an action that does work on the selected vehicles (`run_on_vehicles`)."""

    @wraps(work)
    def run(arguments: Namespace) -> int:
        return run_on_vehicles(arguments, lambda vehicle: work(vehicle, arguments))

    return run


def report(arguments: Namespace, vehicle: Vehicle, text: str, error: Exception | None = None) -> None:
    """Print the outcome of a vehicle."""
    if arguments.json:
        outcome: dict[str, Any] = {"system": vehicle.system, "action": arguments.action, "ok": error is None}
        outcome["text" if error is None else "error"] = text
        echo_json(outcome)
    elif error is None:
        echo(of_vehicle(vehicle, text))
    else:
        echo(f"mav vehicle: {of_vehicle(vehicle, ' '.join(text.split()))}", error=True)


async def _run_on_one(
    vehicle: Vehicle,
    arguments: Namespace,
    work: Callable[[Vehicle], Awaitable[str]],
    remaining: Remaining | None,
) -> int:
    try:
        with _notice(vehicle, arguments):
            async with flight_progress(vehicle, arguments.action, remaining):
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
        with _notice(vehicle, arguments):
            text = await work(vehicle)
    except MavstackError as error:
        report(arguments, vehicle, str(error), error)
        raise
    report(arguments, vehicle, text)


def _notice(vehicle: Vehicle, arguments: Namespace) -> AbstractContextManager[None]:
    """Return the notice of an interruption for actions that a vehicle goes on with."""
    if not getattr(arguments, "wait", False):
        return nullcontext()
    return notice_of_interruption(vehicle, arguments.action, "mav vehicle ")
