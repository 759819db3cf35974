"""`mav data report` and `mav data plot`: a flight as a page, as pictures, or on the terminal."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from html import escape
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.atomic_file import write_file_atomically
from mavstack.cli.common.confirmation import is_confirmed
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import echo, echo_json, terminal_width
from mavstack.cli.data.opening import (
    add_log_options,
    add_selection_options,
    name_of,
    open_file,
    report_damage,
)
from mavstack.cli.data.remote import is_remote
from mavstack.cli.data.terminal_chart import chart_lines
from mavstack.errors import LogError
from mavstack.logs.analysis import flights
from mavstack.logs.report import make_report
from mavstack.logs.report.charts import Chart, Line, aligned, svg_document
from mavstack.logs.report.page import MARK, page_file, plot_page
from mavstack.logs.report.panels import PANELS, charts_of
from mavstack.logs.report.png import png_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.cli.common.actions import Actions
    from mavstack.logs import Log
    from mavstack.logs.message_table import MessageTable


_USUAL_TOPICS: Final = ("attitude", "altitude")
#: Number of bytes at the beginning of a file in which an earlier report is recognised.
_HEAD: Final = 1024


def add_actions(actions: Actions) -> None:
    """Declare the actions."""
    parser = actions.add("report", "a page about a flight: findings, track, charts", report)
    add_log_options(parser)
    parser.add_argument("-o", "--output", metavar="FILE", help="page to write (default: beside the log)")
    parser.add_argument("--json", action="store_true", help="print facts and findings instead of a page")
    parser.add_argument(
        "--force", action="store_true", help="replace files beside the log that are not of an earlier report"
    )
    add_selection_options(parser)
    parser = actions.add("plot", "charts of a flight: PNG, SVG, HTML, or on the terminal", plot)
    add_log_options(parser)
    parser.add_argument(
        "what", nargs="*", metavar="TOPIC|MESSAGE.FIELD", help=f"topics ({', '.join(PANELS)}) or fields"
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", help=".png, .svg or .html to write (default: the terminal)"
    )
    add_selection_options(parser)


def report(arguments: Namespace) -> int:
    """Run `mav data report`."""
    page = _page_path(arguments)
    log = open_file(arguments.file, arguments)
    made = make_report(log)
    if arguments.json:
        echo_json(made.data)
    if page is not None:
        write_file_atomically(page, made.html)
        write_file_atomically(page.with_suffix(".json"), json.dumps(made.data, indent=1) + "\n")
        if not arguments.json:
            _print_findings(made.data, page)
    return report_damage(log, arguments)


def _page_path(arguments: Namespace) -> Path | None:
    """Return the path of the page, or None if none is to be written.

    Raises:
        UsageError: The path is that of the facts beside the page, or there is none beside a URL.
        CommandError: A file would be replaced that the user did not name and no report of this log wrote.
    """
    if arguments.json and arguments.output is None:
        return None
    if arguments.output is None and is_remote(arguments.file):
        raise UsageError("the report of a log at a URL needs -o FILE")
    page = Path(arguments.output or Path(arguments.file).with_suffix(".html"))
    if not page.suffix:
        page = page.with_suffix(".html")
    facts = page.with_suffix(".json")
    if page.suffix.lower() == ".json":
        raise UsageError(
            f"{page}: name the page, such as {page.with_suffix('.html')}; its facts go beside it"
        )
    source = "" if arguments.output else Path(arguments.file).name
    for path in [facts] if arguments.output else [page, facts]:
        if not arguments.force and not _may_be_replaced(path, source) and not _is_agreed(path):
            raise CommandError(
                f"cannot write {path}: it exists and is of no earlier report of this log; "
                "move it away, name another page with -o, or add --force"
            )
    return page


def _is_agreed(path: Path) -> bool:
    """Ask on the terminal whether to replace a file; False without a terminal."""
    if sys.stdin is None or not sys.stdin.isatty():
        return False
    question = f"{path} is of no earlier report of this log; replace it"
    return is_confirmed(Namespace(yes=False), question, "replace a file", refused="nothing was written")


def _may_be_replaced(path: Path, source: str) -> bool:
    """Return whether a file does not exist, is empty, or was written with an earlier report.

    Args:
        path: Path of the file.
        source: Name of the log that the report must be of; empty for any.
    """
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except FileNotFoundError:
        return True
    except OSError:  # writing the file then raises an error with the reason
        return True
    names = (f"<title>{escape(source)}</title>", f'"file": {json.dumps(source)},')
    is_of_source = not source or any(name.encode() in head for name in names)
    return not head or (MARK.encode() in head and is_of_source)


def _print_findings(data: dict[str, object], path: Path) -> None:
    vehicles: list[dict[str, list[dict[str, object]]]] = data["vehicles"]  # type: ignore[assignment]
    for vehicle in vehicles:
        for finding in vehicle["findings"]:
            when = "" if finding["time_s"] is None else f" at {finding['time_s']:.0f} s"
            echo(f"{finding['severity']}: {finding['title']}{when}")
        if not vehicle["findings"]:
            echo("the rules found nothing")
    echo(f"report: {path} (facts: {path.with_suffix('.json')})")


def plot(arguments: Namespace) -> int:
    """Run `mav data plot`."""
    log = open_file(arguments.file, arguments)
    topics = arguments.what or _USUAL_TOPICS
    charts = aligned(chart for what in topics for chart in _charts(log, what))
    if not charts:
        raise LogError(f"{name_of(log, arguments)}: it holds none of {', '.join(topics)}")
    if arguments.output is None:
        width = terminal_width()
        for chart in charts:
            echo(*chart_lines(chart, width))
    else:
        write_file_atomically(arguments.output, _rendered(Path(arguments.output), charts))
    return report_damage(log, arguments)


def _charts(log: Log, what: str) -> Iterator[Chart]:
    if what in PANELS:
        for flight in flights(log):
            yield from charts_of(flight, what)
        return
    table, _, field = what.partition(".")
    if table not in log or not field:
        topics = ", ".join(PANELS)
        raise UsageError(
            f"{what!r} is neither a topic ({topics}) nor a field such as ATTITUDE.roll of this log"
        )
    rows = log[table]
    if not rows.has_number(rows.require_field(field)):
        raise UsageError(f"{what} is no column of numbers; an element of an array is named {what}[0]")
    lines = [line for name, part in _instances(field, rows) for line in _line(log, table, part, field, name)]
    if lines:
        yield Chart(what, rows.schema[field.partition("[")[0]].unit, lines)


def _instances(field: str, rows: MessageTable) -> Iterator[tuple[str, MessageTable]]:
    """Yield the rows of each sensor, port or sender, with a name of the line."""
    names = [name for name in ("_system", rows.schema.instance_field) if name in (rows.dtype.names or ())]
    kinds = [np.unique(rows[name]).tolist() for name in names]
    for values in product(*kinds):
        part = rows
        for name, value in zip(names, values, strict=True):
            part = part.where(part[name] == value)
        several = [
            f"{name.strip('_')} {value}"
            for name, value, kind in zip(names, values, kinds, strict=True)
            if len(kind) > 1
        ]
        yield ", ".join([field, *several]), part


def _line(log: Log, table: str, rows: MessageTable, field: str, name: str) -> Iterator[Line]:
    times, values = log.seconds_from_start(table, rows), rows.scaled(field)
    known = np.flatnonzero(np.isfinite(times) & np.isfinite(values))
    order = known[np.argsort(times[known], kind="stable")]
    if len(order):
        yield Line(name, times[order], values[order])


def _rendered(path: Path, charts: list[Chart]) -> bytes | str:
    match path.suffix.lower():
        case ".png":
            return png_of(charts)
        case ".svg":
            return svg_document(charts, page_file("page.css"))
        case ".html":
            return plot_page(path.stem, charts)
    raise UsageError(f"{path}: the suffix must be .png, .svg or .html")
