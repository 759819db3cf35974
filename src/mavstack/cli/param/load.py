"""`mav param load`: set the parameters of a file, and show the outcome for each."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import align_columns, coloured, echo, echo_json
from mavstack.cli.common.selection import of_vehicle, selects_several
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.param.commit import commit, unsaved_hint
from mavstack.cli.param.text import json_value, matching, parameters_for
from mavstack.files.parameters import Outcome, ParameterLoad, read_parameters, value_text

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.files.parameters import AppliedParameter
    from mavstack.vehicle import Vehicle

_COLOURS = {Outcome.SET: "green", Outcome.SKIPPED: "grey", Outcome.UNCHANGED: "grey"}


def load(arguments: Namespace) -> int:
    """Run `mav param load`."""
    if arguments.everything and selects_several(arguments):
        raise UsageError("--everything sets ids and calibration, which several vehicles cannot share")
    file = read_parameters(arguments.file, arguments.format)

    async def work(vehicle: Vehicle) -> int:
        wanted = matching(arguments.patterns, parameters_for(file, arguments.file, vehicle))
        task = ParameterLoad(
            vehicle.params, wanted.values(), everything=arguments.everything, dry_run=arguments.dry_run
        )
        with TransferProgress("downloading parameters", in_bytes=False) as progress:
            try:
                await task.run(timeout=arguments.action_timeout, progress=progress)
                if arguments.save and not arguments.dry_run:
                    await commit(vehicle)
            finally:
                if any(each.outcome is not Outcome.UNTRIED for each in task.results):
                    _show(vehicle, task.results, arguments)
        return 0 if all(each.ok for each in task.results) else 1

    return run_on_vehicle(arguments, work)


def _show(vehicle: Vehicle, results: tuple[AppliedParameter, ...], arguments: Namespace) -> None:
    if arguments.json:
        unsaved = list(vehicle.params.unsaved)
        facts = {"dry_run": arguments.dry_run, "parameters": [_json(each) for each in results]}
        echo_json({"system": vehicle.system, **facts, "unsaved": unsaved})
        return
    lines = []
    rows = [(each, _row(each)) for each in results if each.outcome is not Outcome.UNCHANGED]
    if rows:
        aligned = align_columns([row for _, row in rows])
        for (result, _), line in zip(rows, aligned, strict=True):
            lines.append(coloured(line, _COLOURS.get(result.outcome, "red")))
    head = [f"vehicle {vehicle.system}:"] if lines and selects_several(arguments) else []
    hint = [] if arguments.dry_run else unsaved_hint(vehicle, saved=arguments.save)
    echo(*head, *lines, of_vehicle(vehicle, _summary(results, dry_run=arguments.dry_run)), *hint)


def _row(result: AppliedParameter) -> tuple[str, str, str]:
    old = "" if result.before is None else value_text(result.before)
    reached = result.after if result.outcome is Outcome.SET else None
    new = value_text(reached if reached is not None and reached is not result.before else result.wanted)
    change = f"{old} -> {new}" if old else new
    if result.outcome is not Outcome.SET:
        return result.name, change, f"{result.outcome.value}: {result.reason}"
    return result.name, change, "takes effect after a reboot" if result.needs_reboot else ""


def _summary(results: tuple[AppliedParameter, ...], *, dry_run: bool) -> str:
    counts = Counter(each.outcome for each in results)
    parts = [f"{counts[outcome]} {outcome.value}" for outcome in Outcome if counts[outcome]]
    text = ", ".join(parts)
    if dry_run:
        text = text.replace(Outcome.SET.value, "to be set") + "; nothing was sent"
    if counts[Outcome.SKIPPED]:
        text += "; --everything also sets the skipped ones"
    if any(each.needs_reboot for each in results) and not dry_run:
        text += "; reboot the vehicle"
    return text


def _json(result: AppliedParameter) -> dict[str, object]:
    return {
        "name": result.name,
        "outcome": result.outcome.value,
        "wanted": json_value(result.wanted),
        "before": json_value(result.before),
        "after": json_value(result.after),
        "reason": result.reason or None,
        "needs_reboot": result.needs_reboot,
    }
