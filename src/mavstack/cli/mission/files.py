"""Plan files of `mav mission`: read, validated and written; a problem or a loss is told in one line."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.cli.common.output import echo, echo_text
from mavstack.errors import PlanFileError
from mavstack.files.plans import check, format_of, format_plan, parse_plan, read_plan
from mavstack.files.plans.model import PLAN_NAMES

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

    from mavstack.files.plans import PlanFile
    from mavstack.services.mission import PlanType

#: The path that stands for standard input and output.
STANDARD = "-"
#: The format of a plan that is written to standard output.
DEFAULT_FORMAT = "waypoints"


def convert(arguments: Namespace) -> int:
    """Run `mav mission convert`."""
    name, plan = read(arguments.input)
    chosen = select_plan_types(plan, arguments.plan_types, name)
    if plan.problems and not arguments.force:
        raise PlanFileError(_first_of(plan.problems, "--force writes the rest"), name)
    save(plan.only(chosen), arguments.output, arguments.format, force=arguments.force)
    return 0


def read(path: str) -> tuple[str, PlanFile]:
    """Read a file or standard input; return its name and its plans."""
    if path != STANDARD:
        return path, read_plan(Path(path))
    return "standard input", parse_plan(sys.stdin.buffer.read(), "standard input")


def select_plan_types(
    plan: PlanFile, plan_types: Sequence[PlanType] | None, name: str
) -> tuple[PlanType, ...]:
    """Return the selected plans of a file, or all plans that it has.

    Raises:
        PlanFileError: A selected plan, or any plan, is missing.
    """
    chosen = tuple(dict.fromkeys(plan_types)) if plan_types else plan.kinds
    missing = [PLAN_NAMES[kind] for kind in chosen if kind not in plan.kinds]
    if missing:
        raise PlanFileError(f"it has no {' and no '.join(missing)}", name)
    if not chosen:
        raise PlanFileError("it has no plans; `mav mission clear` deletes the plans of a vehicle", name)
    return chosen


def validate(plan: PlanFile, name: str) -> None:
    """Raise `PlanFileError` for a plan that no vehicle can fly as intended."""
    problems = [*plan.problems, *map(str, check(plan))]
    if problems:
        advice = f"`mav mission show {name}` shows all problems, --force uploads the plan"
        raise PlanFileError(_first_of(problems, advice), name)


def save(plan: PlanFile, path: str, format: str | None, *, force: bool) -> None:  # noqa: A002
    """Write plans to a file or to standard output.

    Raises:
        PlanFileError: The format cannot hold a part of them, and `force` is not set.
    """
    name = format or (DEFAULT_FORMAT if path == STANDARD else format_of(path))
    where = "" if path == STANDARD else path
    try:
        written = format_plan(plan, name)
    except PlanFileError as error:
        raise PlanFileError(error.problem, where, error.where) from None
    if written.lost and not force:
        problem = _first_of(written.lost, "--force writes the rest, .json holds everything")
        raise PlanFileError(f"the format {name!r} cannot hold {problem}", where)
    for text in (*plan.notes, *written.notes, *written.lost):
        echo(f"mav mission: note: {text}", error=True)
    if path == STANDARD:
        echo_text(written.text)
    else:
        write_file_atomically(path, written.text)


def _first_of(texts: Sequence[str], advice: str) -> str:
    """Return one line for several problems."""
    others = f" (and {len(texts) - 1} more)" if len(texts) > 1 else ""
    return f"{texts[0]}{others}; {advice}"
