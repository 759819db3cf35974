"""`mav data info` and `mav data messages`: the facts of a log, and its tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mavstack.cli.common.output import align_columns, echo, echo_json, table_lines
from mavstack.cli.common.text import duration_text, size_text
from mavstack.cli.data.opening import add_log_options, name_of, open_file, report_damage
from mavstack.errors import UnknownMessageError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator

    from mavstack.cli.common.actions import Actions
    from mavstack.logs import Log
    from mavstack.logs.schema import FieldSchema

_LEFT = frozenset({"MESSAGE", "FIELD", "TYPE", "UNIT", "DESCRIPTION"})


def add_actions(actions: Actions) -> None:
    """Declare the actions."""
    parser = actions.add("info", "facts of a log: vehicle, times, messages, damage", info)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_log_options(parser)
    parser = actions.add("messages", "tables of a log with rates, or the columns of one table", messages)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_log_options(parser)
    parser.add_argument("message", nargs="?", metavar="MESSAGE", help="table whose columns are shown")


def info(arguments: Namespace) -> int:
    """Run `mav data info`."""
    log = open_file(arguments.file, arguments)
    if arguments.json:
        echo_json(info_object(log) | {"file": name_of(log, arguments)})
    else:
        echo(*info_lines(log, name_of(log, arguments)))
    return report_damage(log, arguments) if arguments.strict else 0


def info_object(log: Log) -> dict[str, Any]:
    """Return the facts of a log as values for JSON, with the keys of `mav watch FILE --once --json`."""
    statistics = getattr(log, "statistics", None)
    sources = getattr(log, "sources", {})
    span, start = log.time_span, log.start
    return {
        "file": str(log.path),
        "format": log.format,
        "size": log.size,
        "packets": statistics.packets if statistics is not None else sum(log.counts.values()),
        "messages": dict(sorted(log.counts.items())),
        "unknown": {str(number): count for number, count in sorted(log.skipped.unknown.items())},
        "bad_bytes": log.skipped.bad_bytes,
        "signed": statistics.signed if statistics is not None else 0,
        "sources": [f"{system}/{component}" for system, component in sorted(sources)],
        "duration_s": None if span is None else round(log.duration, 6),
        "start": None if start is None else f"{start}Z",
        "time_base": log.time_base.describe(),
        "info": dict(log.info),
        "parameters": len(log.parameters),
        "skipped": log.skipped.to_dict(),
    }


def info_lines(log: Log, name: str) -> Iterator[str]:
    """Return the facts of a log as lines of text."""
    facts = {"file": f"{name} ({size_text(log.size)}, {log.format})"}
    if log.start is not None:
        facts["begins"] = f"{str(log.start)[:19].replace('T', ' ')} UTC"
    facts["duration"] = duration_text(log.duration) if log.time_span is not None else "unknown"
    facts["clock"] = log.time_base.describe()
    facts |= {name.replace("_", " "): value for name, value in log.info.items()}
    facts["rows"] = f"{sum(log.counts.values()):,} in {len(log)} messages"
    if log.parameters:
        facts["parameters"] = f"{len(log.parameters)}, {len(log.parameter_changes)} changes"
    facts["skipped"] = log.skipped.describe()
    yield from align_columns([(name, value) for name, value in facts.items()])
    if log.texts:
        yield ""
        yield "first and last texts:"
        shown = log.texts if len(log.texts) <= 8 else [*log.texts[:4], None, *log.texts[-4:]]
        yield from (f"  {'…' if text is None else text.text}" for text in shown)


def messages(arguments: Namespace) -> int:
    """Run `mav data messages`."""
    log = open_file(arguments.file, arguments)
    if arguments.message is not None:
        return _columns(log, arguments)
    rows = [(name, count, _rate(log, count)) for name, count in sorted(log.counts.items())]
    if arguments.json:
        echo_json([{"message": name, "rows": count, "rate_hz": rate} for name, count, rate in rows])
    else:
        table = [(name, f"{count:,}", "-" if rate is None else f"{rate:.4g}") for name, count, rate in rows]
        echo(*table_lines(("MESSAGE", "ROWS", "HZ"), table, _LEFT))
    return report_damage(log, arguments)


def _rate(log: Log, count: int) -> float | None:
    """Return the mean rate of a message in hertz."""
    return round(count / log.duration, 4) if log.duration > 0 else None


def _columns(log: Log, arguments: Namespace) -> int:
    if arguments.message not in log:
        name = name_of(log, arguments)
        raise UnknownMessageError(f"{name} contains no {arguments.message}; it contains {', '.join(log)}")
    schema = log.schema(arguments.message)
    if arguments.json:
        echo_json(schema.to_dict())
        return report_damage(log, arguments)
    table = log[arguments.message]
    rows = [
        (field.name, str(field.dtype.base), _unit(field), _range_text(table, field), field.description)
        for field in schema
    ]
    if schema.description:
        echo(f"{schema.name}: {schema.description}")
    echo(*table_lines(("FIELD", "TYPE", "UNIT", "RANGE", "DESCRIPTION"), rows, _LEFT | {"RANGE"}))
    return report_damage(log, arguments)


def _unit(field: FieldSchema) -> str:
    unit = field.unit if field.multiplier == 1 else f"{field.multiplier:g} {field.unit}"
    return unit or (field.enum.name if field.enum is not None else "")


def _range_text(table: Any, field: FieldSchema) -> str:  # noqa: ANN401 (a MessageTable)
    """Return the lowest and the highest value of a column."""
    column = np.asarray(table[field.name])
    if column.dtype.kind not in "iuf" or not column.size:
        return ""
    values = column[np.isfinite(column)] if column.dtype.kind == "f" else column
    return f"{values.min():.6g} … {values.max():.6g}" if values.size else "NaN"
