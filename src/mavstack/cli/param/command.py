"""`mav param`: the parameters of a vehicle, listed, read, set, saved to a file, loaded from one, compared."""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.options import seconds
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.param.diff import diff
from mavstack.cli.param.load import load
from mavstack.cli.param.save import save
from mavstack.cli.param.text import (
    assignments,
    columns,
    fits,
    json_parameter,
    json_value,
    matching,
    parameter_row,
    print_json,
)
from mavstack.errors import RemoteError
from mavstack.files.parameters import FORMATS, needs_reboot, value_text
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Mapping

    from mavstack.services.parameters import Parameter, Value
    from mavstack.vehicle import Vehicle

EXAMPLES = """\
examples:
  mav param list
  mav param list 'RTL*' --json
  mav param get SYSID_THISMAV RTL_ALT
  mav param set RTL_ALT 3000
  mav param set RTL_ALT=3000 RTL_SPEED=500
  mav param save backup.param
  mav param save tuning.params 'ATC*' 'PSC*'
  mav param load backup.param --dry-run
  mav param load backup.param
  mav param diff backup.param
  mav param diff before.param after.params --exit-code
  mav param watch 'RTL*' --for 60
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "param", EXAMPLES)
    _with_patterns(_action(actions, "list", "show parameters", list_all))
    getting = _action(actions, "get", "read some parameters from the vehicle", get)
    getting.add_argument("names", nargs="+", metavar="NAME")
    setting = _action(actions, "set", "set parameters, and see that the vehicle holds them", set_some)
    setting.add_argument("words", nargs="+", metavar="NAME VALUE", help="or NAME=VALUE; any number of them")
    _add_save(_action(actions, "save", "save parameters to a file", save))
    _add_load(_action(actions, "load", "set what a file holds, and tell what changed", load))
    _add_diff(_action(actions, "diff", "compare a file with the vehicle, or with another file", diff))
    watching = _action(actions, "watch", "show parameters that change, whoever changes them", watch)
    _with_patterns(watching)
    watching.add_argument(
        "--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time"
    )


def run(arguments: Namespace) -> int:
    """Carry out the action that was chosen."""
    code: int = arguments.run_action(arguments)
    return code


def list_all(arguments: Namespace) -> int:
    """`mav param list`."""

    async def work(vehicle: Vehicle) -> int:
        found = matching(arguments.patterns, await fetched(vehicle))
        show([found[name] for name in sorted(found)], as_json=arguments.json)
        return 0

    return run_on_vehicle(arguments, work)


def get(arguments: Namespace) -> int:
    """`mav param get`; what was read is shown, though another could not be."""

    async def work(vehicle: Vehicle) -> int:
        found: list[Parameter] = []
        failures: list[RemoteError] = []
        for name in arguments.names:
            try:
                found.append(await vehicle.params.get(name.upper()))
            except RemoteError as error:
                failures.append(error)
        if found:
            show(found, as_json=arguments.json)
        return _told(failures)

    return run_on_vehicle(arguments, work)


def set_some(arguments: Namespace) -> int:
    """`mav param set`."""
    wanted = assignments(arguments.words)

    async def work(vehicle: Vehicle) -> int:
        failures = []
        for name, value in wanted.items():
            try:
                before, after = await _set(vehicle, name.upper(), value)
            except RemoteError as error:
                failures.append(error)
            else:
                _show_set(before, after, as_json=arguments.json)
        return _told(failures)

    return run_on_vehicle(arguments, work)


def watch(arguments: Namespace) -> int:
    """`mav param watch`."""

    async def work(vehicle: Vehicle) -> int:
        known = await fetched(vehicle)
        matching(arguments.patterns, known)  # a pattern that fits nothing is a mistake
        async with vehicle.params.changes() as changes, asyncio.timeout(arguments.duration):
            async for change in changes:
                fresh = change.previous is not None or change.parameter.name not in known
                if fresh and fits(change.parameter.name, arguments.patterns):
                    _show_change(change.previous, change.parameter, as_json=arguments.json)
        return 1  # the connection was closed under it

    async def until_time_is_up(vehicle: Vehicle) -> int:
        try:
            return await work(vehicle)
        except TimeoutError as error:
            if isinstance(error, RemoteError):
                raise
            return 0

    return run_on_vehicle(arguments, until_time_is_up)


async def fetched(vehicle: Vehicle) -> Mapping[str, Parameter]:
    """All parameters of a vehicle, with progress on a terminal."""
    with TransferProgress("fetching parameters", in_bytes=False) as progress:
        return dict(await vehicle.params.download(progress=progress))


def show(parameters: list[Parameter], *, as_json: bool) -> None:
    """Show parameters in columns, or as a JSON array."""
    if as_json:
        print_json([json_parameter(each) for each in parameters])
    else:
        print(*columns([parameter_row(each) for each in parameters], right=frozenset({1})), sep="\n")


async def _set(vehicle: Vehicle, name: str, value: Value) -> tuple[Parameter, Parameter]:
    """Set one: as it was, and as it is."""
    before = await vehicle.params.get(name)
    return before, await with_status_texts(vehicle, vehicle.params.set(name, value))


def _show_set(before: Parameter, after: Parameter, *, as_json: bool) -> None:
    reboot = needs_reboot(after.name) and before.value != after.value
    if as_json:
        print_json({**json_parameter(after), "before": json_value(before), "needs_reboot": reboot})
        return
    old, new = value_text(before), value_text(after)
    hint = "; it counts after a reboot" if reboot else ""
    print(f"{after.name}: {new}, as before" if old == new else f"{after.name}: {old} -> {new}{hint}")


def _show_change(before: Parameter | None, after: Parameter, *, as_json: bool) -> None:
    if as_json:
        print_json({**json_parameter(after), "before": json_value(before)})
    else:
        print(
            f"{after.name}: {'?' if before is None else value_text(before)} -> {value_text(after)}",
            flush=True,
        )


def _told(failures: list[RemoteError]) -> int:
    """Tell what failed, a line each; the exit code."""
    for error in failures:
        print(f"mav param: {error}", file=sys.stderr)
    return 1 if failures else 0


def _action(actions: Actions, name: str, summary: str, run_it: Callable[[Namespace], int]) -> ArgumentParser:
    """An action with what all have in common."""
    parser = actions.add(name, summary, run_it)
    parser.add_argument("--json", action="store_true", help="for programs")
    add_connection_options(parser)
    return parser


def _with_patterns(parser: ArgumentParser) -> None:
    parser.add_argument(
        "patterns", nargs="*", metavar="PATTERN", help="names, * for any letters (default: all parameters)"
    )


def _add_save(parser: ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE", help="- for standard output")
    _with_patterns(parser)
    _add_format(parser, "of the file (default: by its suffix)")


def _add_load(parser: ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE")
    _with_patterns(parser)
    parser.add_argument("--dry-run", action="store_true", help="only tell what would be set")
    parser.add_argument(
        "--all",
        action="store_true",
        help="also what belongs to one vehicle: its id, calibration and counters",
    )
    _add_format(parser, "of the file (default: by what is in it)")


def _add_diff(parser: ArgumentParser) -> None:
    parser.add_argument("files", nargs="+", metavar="FILE", help="one to compare with the vehicle, or two")
    parser.add_argument(
        "--all", action="store_true", help="also counters, and what only the vehicle has and not the file"
    )
    parser.add_argument("--exit-code", action="store_true", help="exit with 1 if there are differences")


def _add_format(parser: ArgumentParser, what: str) -> None:
    parser.add_argument("--format", choices=list(FORMATS), help=what)
