"""`mav param`: list, read, set, save, load and compare the parameters of a vehicle."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_vehicle_action, on_vehicle, run_on_vehicle
from mavstack.cli.common.errors import CommandError, failure_text
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.common.selection import of_vehicle, selects_several
from mavstack.cli.ftp.limited import add_timeout_option
from mavstack.cli.param.commit import add_save_option, commit, unsaved_hint
from mavstack.cli.param.diff import diff
from mavstack.cli.param.download import download_parameters
from mavstack.cli.param.load import load
from mavstack.cli.param.metadata import (
    add_metadata_option,
    description_lines,
    json_metadata,
    metadata_for_checks,
    metadata_to_show,
)
from mavstack.cli.param.save import save
from mavstack.cli.param.text import (
    assignments,
    json_parameter,
    json_value,
    matches_any,
    matching,
    parameter_row,
)
from mavstack.errors import MavstackError, RemoteError
from mavstack.files.parameters import FORMATS, needs_reboot, value_text
from mavstack.services.parameters.metadata import number_text
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.services.parameters import MetadataTable, Parameter, Value
    from mavstack.vehicle import Vehicle

EXAMPLES = """\
examples:
  mav param list
  mav param list 'RTL*' --json
  mav param get SYSID_THISMAV RTL_ALT
  mav param get -v RTL_ALT
  mav param get -v RTL_ALT --metadata apm.pdef.xml
  mav param set RTL_ALT 3000
  mav param set RTL_ALT 20 --force
  mav param set RTL_ALT 2500 --save
  mav param set RTL_ALT=3000 RTL_SPEED=500
  mav param set RTL_ALT 3000 --systems 1,3-5
  mav param save backup.param
  mav param save 'vehicle-{system}.param' --all
  mav param save tuning.params 'ATC*' 'PSC*'
  mav param load backup.param --dry-run
  mav param load backup.param
  mav param load backup.param --save
  mav param load tuning.params --all
  mav param diff backup.param
  mav param diff before.param after.params --exit-code
  mav param watch 'RTL*' --for 60
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "param", EXAMPLES)
    action = add_vehicle_action(actions, "list", "list the parameters of the vehicle", list_all, fleet=True)
    _add_patterns(action)
    add_timeout_option(action)
    action = add_vehicle_action(actions, "get", "read parameters from the vehicle", get, fleet=True)
    action.add_argument("names", nargs="+", metavar="NAME", help="name of a parameter")
    action.add_argument(
        "-v",
        "--describe",
        action="store_true",
        help="also show description, unit, range, named values and bits",
    )
    add_metadata_option(action)
    action = add_vehicle_action(
        actions, "set", "set parameters, and verify their values", set_values, fleet=True, changes=True
    )
    action.add_argument("words", nargs="+", metavar="NAME VALUE", help="or NAME=VALUE; may be repeated")
    action.add_argument(
        "--force", action="store_true", help="also set values outside of the range that the metadata states"
    )
    add_save_option(action)
    add_metadata_option(action)
    _add_save_arguments(
        add_vehicle_action(actions, "save", "save the parameters to a file", save, fleet=True)
    )
    _add_load_arguments(
        add_vehicle_action(
            actions,
            "load",
            "set the parameters of a file, and show what changed",
            load,
            fleet=True,
            changes=True,
        )
    )
    _add_diff_arguments(
        add_vehicle_action(
            actions, "diff", "compare a file with the vehicle, or with another file", diff, fleet=True
        )
    )
    action = add_vehicle_action(actions, "watch", "show parameters when they change", watch, fleet=True)
    _add_patterns(action)
    action.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")


@on_vehicle
async def list_all(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav param list`."""
    found = matching(arguments.patterns, await download_parameters(vehicle, arguments))
    show(vehicle, [found[name] for name in sorted(found)], arguments)
    return 0


@on_vehicle
async def get(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav param get`; a parameter that cannot be read does not stop the others."""
    found: list[Parameter] = []
    failures: list[RemoteError] = []
    for name in arguments.names:
        try:
            found.append(await vehicle.params.get(name.upper()))
        except RemoteError as error:
            failures.append(error)
    if found and arguments.describe:
        await _describe(vehicle, found, arguments)
    elif found:
        show(vehicle, found, arguments)
    return _report_failures(vehicle, failures)


def set_values(arguments: Namespace) -> int:
    """Run `mav param set`."""
    wanted = assignments(arguments.words)

    async def work(vehicle: Vehicle) -> int:
        failures: list[MavstackError] = []
        changes: list[tuple[Parameter, Parameter]] = []
        metadata = await metadata_for_checks(vehicle, arguments)
        try:
            for name, value in wanted.items():
                try:
                    _check(metadata, vehicle, name.upper(), value)
                    changes.append(await _set(vehicle, name.upper(), value))
                except (RemoteError, CommandError) as error:
                    failures.append(error)
            if arguments.save and changes:
                await commit(vehicle)
        except RemoteError as error:
            failures.append(error)
        finally:
            _show_changes(vehicle, changes, metadata, arguments)
        return _report_failures(vehicle, failures)

    return run_on_vehicle(arguments, work)


def watch(arguments: Namespace) -> int:
    """Run `mav param watch`."""

    async def work(vehicle: Vehicle) -> int:
        known = await download_parameters(vehicle, arguments)
        matching(arguments.patterns, known)  # raises for a pattern that matches no parameter
        async with vehicle.params.changes() as changes, asyncio.timeout(arguments.duration):
            async for change in changes:
                changed = change.previous is not None or change.parameter.name not in known
                if changed and matches_any(change.parameter.name, arguments.patterns):
                    _show_change(vehicle, change.previous, change.parameter, arguments)
        return 1  # the changes ended because the connection was closed

    async def until_time_is_up(vehicle: Vehicle) -> int:
        try:
            return await work(vehicle)
        except TimeoutError as error:
            if isinstance(error, RemoteError):
                raise
            return 0

    return run_on_vehicle(arguments, until_time_is_up)


def show(vehicle: Vehicle, parameters: list[Parameter], arguments: Namespace) -> None:
    """Print parameters in columns or as a JSON array; of several vehicles each is named."""
    several = selects_several(arguments)
    if arguments.json:
        found = [json_parameter(each) for each in parameters]
        echo_json({"system": vehicle.system, "parameters": found} if several else found)
        return
    head = [f"vehicle {vehicle.system}:"] if several else []
    echo(*head, *align_columns([parameter_row(each) for each in parameters], right=frozenset({1})))


async def _describe(vehicle: Vehicle, parameters: list[Parameter], arguments: Namespace) -> None:
    """Print parameters with their metadata."""
    metadata = await metadata_to_show(vehicle, arguments)
    several = selects_several(arguments)
    if arguments.json:
        found = [
            {**json_parameter(each), "metadata": json_metadata(metadata.get(each.name))}
            for each in parameters
        ]
        echo_json({"system": vehicle.system, "parameters": found} if several else found)
        return
    head = [f"vehicle {vehicle.system}:"] if several else []
    lines = [line for each in parameters for line in description_lines(each, metadata.get(each.name))]
    echo(*head, *lines)


def _check(metadata: MetadataTable, vehicle: Vehicle, name: str, value: Value) -> None:
    """Raise if the metadata does not allow a value."""
    problem = metadata.problem(name, value)
    if problem is not None:
        target = f"setting parameter {name} to {number_text(value)} on {vehicle.address}"
        raise CommandError(f"{target} failed: {problem}; --force sends it anyway")


async def _set(vehicle: Vehicle, name: str, value: Value) -> tuple[Parameter, Parameter]:
    """Set a parameter; return it before and after."""
    before = await vehicle.params.get(name)
    return before, await with_status_texts(vehicle, vehicle.params.set(name, value))


def _show_changes(
    vehicle: Vehicle,
    changes: list[tuple[Parameter, Parameter]],
    metadata: MetadataTable,
    arguments: Namespace,
) -> None:
    for before, after in changes:
        _show_set(vehicle, before, after, metadata, as_json=arguments.json)
    if changes and not arguments.json:
        echo(*unsaved_hint(vehicle, saved=arguments.save))


def _show_set(
    vehicle: Vehicle, before: Parameter, after: Parameter, metadata: MetadataTable, *, as_json: bool
) -> None:
    described = metadata.get(after.name)
    delayed = needs_reboot(after.name) or (described is not None and described.reboot_required)
    reboot = delayed and before.value != after.value
    if as_json:
        saved = after.name not in vehicle.params.unsaved
        facts = {"before": json_value(before), "needs_reboot": reboot, "saved": saved}
        echo_json({"system": vehicle.system, **json_parameter(after), **facts})
        return
    old, new = value_text(before), value_text(after)
    hint = "; takes effect after a reboot" if reboot else ""
    change = f"{new}, unchanged" if old == new else f"{old} -> {new}{hint}"
    echo(of_vehicle(vehicle, f"{after.name}: {change}"))


def _show_change(vehicle: Vehicle, before: Parameter | None, after: Parameter, arguments: Namespace) -> None:
    if arguments.json:
        echo_json({"system": vehicle.system, **json_parameter(after), "before": json_value(before)})
        return
    text = f"{after.name}: {'?' if before is None else value_text(before)} -> {value_text(after)}"
    echo(of_vehicle(vehicle, text) if selects_several(arguments) else text)


def _report_failures(vehicle: Vehicle, failures: Sequence[MavstackError]) -> int:
    """Print a line for each failure and return the exit code."""
    for error in failures:
        echo(f"mav param: {of_vehicle(vehicle, failure_text(error))}", error=True)
    return 1 if failures else 0


def _add_patterns(parser: ArgumentParser) -> None:
    parser.add_argument(
        "patterns", nargs="*", metavar="PATTERN", help="name, * for any letters (default: all parameters)"
    )


def _add_save_arguments(parser: ArgumentParser) -> None:
    parser.add_argument(
        "file",
        metavar="FILE",
        help="file to write, - for standard output; {system} in the name stands for the system id",
    )
    _add_patterns(parser)
    _add_format(parser, "format of the file (default: by its suffix)")
    add_timeout_option(parser)


def _add_load_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE", help="parameter file of any known format")
    _add_patterns(parser)
    parser.add_argument("--dry-run", action="store_true", help="show what would be set, and set nothing")
    parser.add_argument(
        "--everything",
        action="store_true",
        help="also set what belongs to one vehicle: its id, calibration and counters",
    )
    add_save_option(parser)
    _add_format(parser, "format of the file (default: by its content)")
    add_timeout_option(parser)


def _add_diff_arguments(parser: ArgumentParser) -> None:
    parser.add_argument(
        "files", nargs="+", metavar="FILE", help="file to compare with the vehicle, or two files"
    )
    parser.add_argument(
        "--everything",
        action="store_true",
        help="also show counters, and parameters that only the vehicle has",
    )
    parser.add_argument("--exit-code", action="store_true", help="exit with 1 if there are differences")
    add_timeout_option(parser)


def _add_format(parser: ArgumentParser, text: str) -> None:
    parser.add_argument("--format", choices=list(FORMATS), help=text)
