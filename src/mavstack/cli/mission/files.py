"""Files of `mav mission`: read, judged and written, with what is wrong or lost told in one line."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.errors import PlanFileError
from mavstack.files.plans import check, format_of, format_plan, parse_plan, read_plan
from mavstack.files.plans.model import KINDS

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

    from mavstack.files.plans import PlanFile
    from mavstack.services.mission import PlanType

STANDARD = "-"
#: What is written to standard output, where nothing else is asked for.
USUAL_FORMAT = "waypoints"


def convert(arguments: Namespace) -> int:
    """`mav mission convert`."""
    name, plan = read(arguments.input)
    chosen = chosen_of(plan, arguments.kinds, name)
    if plan.problems and not arguments.force:
        raise PlanFileError(_first_of(plan.problems, "--force writes the rest"), name)
    save(plan.only(chosen), arguments.output, arguments.format, force=arguments.force)
    return 0


def read(path: str) -> tuple[str, PlanFile]:
    """What a file or standard input holds, and what it is called."""
    if path != STANDARD:
        return path, read_plan(Path(path))
    return "standard input", parse_plan(sys.stdin.buffer.read(), "standard input")


def chosen_of(plan: PlanFile, kinds: Sequence[PlanType] | None, name: str) -> tuple[PlanType, ...]:
    """Which plans of a file are meant: those named, or all that it has."""
    chosen = tuple(dict.fromkeys(kinds)) if kinds else plan.kinds
    missing = [KINDS[kind] for kind in chosen if kind not in plan.kinds]
    if missing:
        raise PlanFileError(f"it has no {' and no '.join(missing)}", name)
    if not chosen:
        raise PlanFileError("it holds nothing: `mav mission clear` empties a vehicle", name)
    return chosen


def judge(plan: PlanFile, name: str) -> None:
    """Refuse a plan that no vehicle could fly as it is meant."""
    wrong = [*plan.problems, *map(str, check(plan))]
    if wrong:
        raise PlanFileError(_first_of(wrong, f"`mav mission show {name}` tells all, --force sends it"), name)


def save(plan: PlanFile, path: str, format: str | None, *, force: bool) -> None:  # noqa: A002
    """Write plans to a file or to standard output, unless something of them would be lost."""
    name = format or (USUAL_FORMAT if path == STANDARD else format_of(path))
    where = "" if path == STANDARD else path
    try:
        written = format_plan(plan, name)
    except PlanFileError as error:
        raise PlanFileError(error.problem, where, error.where) from None
    if written.lost and not force:
        problem = _first_of(written.lost, "--force writes the rest, .json holds everything")
        raise PlanFileError(f"the format {name!r} cannot hold {problem}", where)
    for text in (*plan.notes, *written.notes, *written.lost):
        print(f"mav mission: note: {text}", file=sys.stderr)
    if path == STANDARD:
        print(written.text, end="")
    else:
        Path(path).write_text(written.text, encoding="utf-8", newline="\n")


def _first_of(texts: Sequence[str], advice: str) -> str:
    """One line for several problems."""
    others = f" (and {len(texts) - 1} more)" if len(texts) > 1 else ""
    return f"{texts[0]}{others}; {advice}"
