"""`mav param diff`: compare a parameter file with the vehicle, or with another file."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING, TypeAlias

from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import align_columns, coloured, echo, echo_json
from mavstack.cli.common.selection import of_vehicle
from mavstack.cli.param.download import download_parameters
from mavstack.cli.param.text import json_value, parameters_for
from mavstack.files.parameters import Owner, compare, owner_of, read_parameters, value_text

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.files.parameters import AnyParameter, Comparison
    from mavstack.vehicle import Vehicle

#: The name of a parameter, and the parameter on the left and on the right side of the comparison.
Row: TypeAlias = "tuple[str, AnyParameter | None, AnyParameter | None]"

_NONE = "-"


def diff(arguments: Namespace) -> int:
    """Run `mav param diff`."""
    if len(arguments.files) > 2:
        raise UsageError("diff compares at most two files")
    ours = read_parameters(arguments.files[0])
    if len(arguments.files) == 2:
        found = compare(ours.by_name(), read_parameters(arguments.files[1]).by_name())
        return _show(found, (arguments.files[0], arguments.files[1]), arguments)

    async def work(vehicle: Vehicle) -> int:
        theirs = await download_parameters(vehicle, arguments)
        found = compare(parameters_for(ours, arguments.files[0], vehicle), theirs)
        heads = (arguments.files[0], f"vehicle {vehicle.system}")
        return _show(found, heads, arguments, vehicle)

    return run_on_vehicle(arguments, work)


def _show(
    found: Comparison, heads: tuple[str, str], arguments: Namespace, vehicle: Vehicle | None = None
) -> int:
    """Print a comparison; the parameters that only a vehicle has are counted unless all are wanted."""
    partial = vehicle is not None and not arguments.everything
    rows: list[Row] = [(each.name, each.ours, each.theirs) for each in found.different]
    rows += [(each.name, each, None) for each in found.only_ours]
    rows += [] if partial else [(each.name, None, each) for each in found.only_theirs]
    rows = [row for row in rows if arguments.everything or owner_of(row[0]) is not Owner.COUNTER]
    rows.sort(key=itemgetter(0))
    if arguments.json:
        system = {} if vehicle is None else {"system": vehicle.system}
        echo_json({**system, **_json(found, rows)})
    else:
        _print(rows, heads)
        text = _summary(found, len(rows), partial=partial)
        echo(text if vehicle is None else of_vehicle(vehicle, text))
    return 1 if rows and arguments.exit_code else 0


def _print(rows: list[Row], heads: tuple[str, str]) -> None:
    if not rows:
        return
    cells = [
        (name, *(_NONE if each is None else value_text(each) for each in sides)) for name, *sides in rows
    ]
    head, *lines = align_columns([("", *heads), *cells], right=frozenset({1, 2}))
    echo(head)
    for (_, ours, theirs), line in zip(rows, lines, strict=True):
        echo(coloured(line, "red" if theirs is None else "green" if ours is None else "yellow"))


def _summary(found: Comparison, shown: int, *, partial: bool) -> str:
    text = f"{shown} different, {len(found.same)} equal" if shown else f"{len(found.same)} equal"
    if partial and found.only_theirs:
        text += f", {len(found.only_theirs)} only on the vehicle (--everything shows them)"
    return text


def _json(found: Comparison, rows: list[Row]) -> dict[str, object]:
    return {
        "same": len(found.same),
        "different": [
            {"name": name, "ours": json_value(ours), "theirs": json_value(theirs)}
            for name, ours, theirs in rows
        ],
    }
