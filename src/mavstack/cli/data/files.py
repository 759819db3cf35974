"""`mav data diff`, `merge`, `repair`, `replay` and `book`: whole files, and folders of them."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import system_id
from mavstack.cli.common.output import echo, echo_json, table_lines
from mavstack.cli.common.text import duration_text, size_text
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.data.opening import add_log_options, add_raw_text, local_file, open_file, report_damage
from mavstack.cli.data.remote import expand
from mavstack.dialects.lookup import find_dialect
from mavstack.logs import merge_logs
from mavstack.logs.book import FlightBook
from mavstack.logs.compare import mission_differences, parameter_differences
from mavstack.logs.export import export_log, exporter_names
from mavstack.logs.repair import repair_log

if TYPE_CHECKING:
    from mavstack.cli.common.actions import Actions
    from mavstack.logs.compare import Difference

_BOOK_NAME = "flights.duckdb"


def add_actions(actions: Actions) -> None:
    """Declare the actions."""
    parser = actions.add("diff", "parameters and missions that differ between logs", diff)
    add_log_options(parser, several=True)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    # The attribute is not named `system`: the rows of a ground station hold the missions that it uploaded.
    parser.add_argument(
        "--system",
        dest="vehicle",
        type=system_id,
        metavar="ID",
        help="this vehicle (default: the first one in each log)",
    )
    parser = actions.add("merge", "logs of one flight on one timeline, such as a tlog and a .BIN", merge)
    add_log_options(parser, several=True)
    parser.add_argument("--to", choices=exporter_names(), metavar="FORMAT", help="write the merged log")
    parser.add_argument("-o", "--output", metavar="PATH", help="file or folder to write")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser = actions.add("repair", "copy what a damaged tlog, .BIN or .ulg still holds", repair)
    add_log_options(parser)
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="new file")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser = actions.add("replay", "send a tlog over a link, as fast as it was recorded", replay)
    add_log_options(parser)
    parser.add_argument(
        "--to",
        required=True,
        metavar="URL",
        help="link to send to; with {system} in it each vehicle has a link of its own",
    )
    parser.add_argument("--speed", default="1", metavar="X", help="X times as fast, or max")
    parser.add_argument("--system", type=int, metavar="ID", help="only this system")
    parser = actions.add("book", "a flight book of all logs below a folder", book)
    parser.add_argument("folder", metavar="FOLDER", help="folder with logs")
    parser.add_argument(
        "-o", "--output", metavar="FILE", help=f"DuckDB file of the book (default: FOLDER/{_BOOK_NAME})"
    )
    parser.add_argument("--csv", metavar="FILE", help="write the book as CSV too")
    add_raw_text(parser)
    parser.add_argument("--incident", nargs=2, metavar=("LOG", "TEXT"), help="write a remark about a log")
    parser.add_argument("--json", action="store_true", help="print one JSON object per flight")
    parser.add_argument("--strict", action="store_true", help="fail if a log holds anything that was skipped")


def diff(arguments: Namespace) -> int:
    """Run `mav data diff`; the exit code is 0 with and without differences."""
    if len(arguments.files) != 2:
        raise UsageError(f"two logs are compared, got {len(arguments.files)}")
    first, second = (open_file(path, arguments) for path in arguments.files)
    parameters = parameter_differences(first, second, system=arguments.vehicle)
    mission = mission_differences(first, second, system=arguments.vehicle)
    if arguments.json:
        echo_json(
            {
                "parameters": [asdict(item) for item in parameters],
                "mission": [asdict(item) for item in mission],
            }
        )
    else:
        _print_differences("parameters", parameters)
        _print_differences("mission", mission)
    return max(report_damage(log, arguments) for log in (first, second))


def _print_differences(title: str, differences: list[Difference]) -> None:
    if not differences:
        echo(f"{title}: no difference")
        return
    rows = [(item.name, _value(item.first), _value(item.second)) for item in differences]
    echo(*table_lines((title.upper(), "FIRST", "SECOND"), rows, {title.upper(), "FIRST", "SECOND"}))


def _value(value: float | str | None) -> str:
    return "-" if value is None else value if isinstance(value, str) else f"{value:.9g}"


def merge(arguments: Namespace) -> int:
    """Run `mav data merge`."""
    if len(arguments.files) < 2:
        raise UsageError("name two logs of one flight, or more")
    if (arguments.to is None) != (arguments.output is None):
        raise UsageError("--to and -o belong together")
    logs = [open_file(path, arguments) for path in expand(arguments.files)]
    merged = merge_logs(*logs)
    written = {}
    if arguments.to is not None:
        with TransferProgress("writing") as progress:
            written = export_log(merged, arguments.to, arguments.output, progress=progress).to_dict()
    if arguments.json:
        echo_json({"offsets": [offset.to_dict() for offset in merged.offsets], **written})
    else:
        echo(*(offset.describe() for offset in merged.offsets))
        if written:
            echo(f"{written['description']} -> {arguments.output}")
    return max(report_damage(log, arguments) for log in logs)


def repair(arguments: Namespace) -> int:
    """Run `mav data repair`."""
    dialect = find_dialect(arguments.dialect)
    with TransferProgress(f"repairing {arguments.file}") as progress:
        source = local_file(arguments.file, arguments)
        result = repair_log(source, arguments.output, dialect, progress, format=arguments.format)
    if arguments.json:
        echo_json(result.to_dict())
    else:
        noun = {"dataflash": "records", "ulog": "messages"}.get(result.format, "packets")
        reasons = f" ({result.damage.describe()})" if result.damage else ""
        echo(
            f"{arguments.output}: {result.records:,} {noun} ({size_text(result.kept_bytes)}), "
            f"{result.dropped_bytes:,} bytes dropped{reasons}"
        )
    return 1 if arguments.strict and result.dropped_bytes else 0


def replay(arguments: Namespace) -> int:
    """Run `mav data replay`, which is `mav watch FILE --to URL` without a display."""
    from argparse import ArgumentParser

    from mavstack.cli.watch import command as watch

    parser = ArgumentParser()
    watch.add_arguments(parser)
    words = [
        local_file(arguments.file, arguments),
        "--to",
        arguments.to,
        "--speed",
        arguments.speed,
        "--once",
    ]
    words += ["--dialect", arguments.dialect]
    if arguments.system is not None:
        words += ["--system", str(arguments.system)]
    parsed = parser.parse_args(words, Namespace())
    parsed.command = "data"
    code = watch.run(parsed)
    return code or (report_damage(open_file(arguments.file, arguments), arguments) if arguments.strict else 0)


def book(arguments: Namespace) -> int:
    """Run `mav data book`."""
    path = Path(arguments.output or Path(arguments.folder) / _BOOK_NAME)
    with FlightBook(path) as flight_book:
        with TransferProgress("reading logs", in_bytes=False) as progress:
            update = flight_book.update(arguments.folder, progress)
        if arguments.incident is not None and not flight_book.add_incident(*arguments.incident):
            raise UsageError(f"the book has no log {arguments.incident[0]}")
        if arguments.csv is not None:
            flight_book.export_csv(arguments.csv, raw_text=arguments.raw_text)
        rows = flight_book.rows()
    for name, problem in update.failed.items():
        named = Path(name).name in problem
        echo(f"mav data: {problem}" if named else f"mav data: {name}: {problem}", error=True)
    for name, skipped in update.skipped.items():
        echo(f"mav data: {name}: skipped {skipped}", error=True)
    if arguments.json:
        for row in rows:
            echo_json({name: str(value) if hasattr(value, "year") else value for name, value in row.items()})
    else:
        head = ("DATE", "FILE", "VEHICLE", "TYPE", "FLIGHT TIME", "TAKEOFFS", "DISTANCE", "FINDINGS")
        echo(*table_lines(head, [_book_row(row) for row in rows], {"DATE", "FILE", "TYPE", "FINDINGS"}))
        counts = f"{update.read} read, {update.unchanged} unchanged, {update.removed} removed"
        echo(f"{path}: {len(rows)} flights; logs: {counts}, {len(update.failed)} failed", error=True)
    damaged = arguments.strict and any(row["skipped"] for row in rows)
    return 1 if update.failed or damaged else 0


def _book_row(row: dict[str, object]) -> tuple[str, ...]:
    duration, distance = row["flight_time_s"], row["distance_m"]
    return (
        str(row["date"] or "-"),
        str(row["file"]),
        str(row["vehicle"]),
        str(row["vehicle_type"]),
        "-" if duration is None else duration_text(float(str(duration))),
        str(row["takeoffs"]),
        "-" if distance is None else f"{float(str(distance)):,.0f} m",
        str(row["incidents"] or row["findings"]),
    )
