"""`mav data query`: SQL over logs with DuckDB, and a short form for everyday questions."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.output import echo, echo_json, table_lines
from mavstack.cli.data.opening import (
    add_log_options,
    add_raw_text,
    add_selection_options,
    open_file,
    report_damage,
)
from mavstack.cli.data.remote import expand
from mavstack.logs.export.csv_text import escape_formula
from mavstack.logs.query import query_logs

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable

    from mavstack.cli.common.actions import Actions

#: Maximum number of rows of a result that are shown on a terminal.
_MAX_SHOWN = 200


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    parser = actions.add("query", "ask logs in SQL, or in a short form", query)
    add_log_options(parser, several=True)
    parser.add_argument(
        "query", metavar="QUERY", help="SQL with messages as tables, or MESSAGE.FIELD, … [where CONDITION]"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object per row")
    parser.add_argument("--csv", action="store_true", help="print CSV")
    parser.add_argument("--scaled", action="store_true", help="values in their units")
    parser.add_argument("--enums", action="store_true", help="names of enum values instead of numbers")
    add_raw_text(parser)
    add_selection_options(parser)


def query(arguments: Namespace) -> int:
    """Run `mav data query`."""
    logs = [open_file(path, arguments) for path in expand(arguments.files)]
    names, rows = query_logs(logs, arguments.query, scaled=arguments.scaled, enums=arguments.enums)
    if arguments.json:
        for row in rows:
            echo_json({name: _plain(value) for name, value in zip(names, row, strict=True)})
    elif arguments.csv or not sys.stdout.isatty():
        _print_csv(names, rows, (lambda value: value) if arguments.raw_text else escape_formula)
    else:
        _print_table(names, rows)
    return max(report_damage(log, arguments) for log in logs)


def _print_csv(names: list[str], rows: list[tuple[Any, ...]], cell: Callable[[object], object]) -> None:
    """Print CSV, whose cells are made by `cell`."""
    import csv

    writer = csv.writer(_Lines(), lineterminator="")
    writer.writerow([cell(name) for name in names])
    writer.writerows([cell(_plain(value)) for value in row] for row in rows)


class _Lines:
    """A text file whose lines are printed."""

    def write(self, line: str) -> None:
        """Print a line."""
        echo(line, flush=False)


def _print_table(names: list[str], rows: list[tuple[Any, ...]]) -> None:
    shown = [tuple(_text(value) for value in row) for row in rows[:_MAX_SHOWN]]
    texts = {
        name for index, name in enumerate(names) if any(isinstance(row[index], str) for row in rows[:50])
    }
    echo(*table_lines(names, shown, texts))
    if len(rows) > _MAX_SHOWN:
        echo(f"… {len(rows) - _MAX_SHOWN:,} more rows; in a pipe or with --csv all are printed", error=True)


def _text(value: object) -> str:
    return f"{value:.7g}" if isinstance(value, float) else "" if value is None else str(_plain(value))


def _plain(value: Any) -> Any:  # noqa: ANN401 (any value of a database)
    """Return a value that JSON and CSV can hold."""
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return None
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return value.isoformat() if hasattr(value, "isoformat") else str(value)
