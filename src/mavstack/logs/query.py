"""Queries of logs: SQL by DuckDB, with the messages as tables, and a short form.

The names of the tables are those of the messages. A query over several logs sees the rows of all of them,
with the column `_file`. Only the tables that the query names are decoded. Times are in UTC. If the query
names `armed` or `mode`, every table has these columns: the state of the vehicle at the time of the row.

SQL ignores the case of names. Of tables whose names differ in case only, a query names each exactly after
FROM or JOIN, or with its number (`ATT_1`, `att_2`); columns that differ in case only have such numbers. A
field `Mode` of a message is the field: the state is not added beside it.

The short form is `MESSAGE.FIELD, … [where CONDITION]`: `ATTITUDE.roll where abs(roll) > 0.5` gives the time
and the fields of one message. DuckDB knows many functions: `histogram`, `quantile_cont`, `time_bucket`, and
ASOF joins.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.errors import InvalidArgumentError, LogError, MissingExtraError
from mavstack.logs.flight_states import flight_states

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.log import Log

_WORD: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_COMMENT: Final = re.compile(r"--[^\n]*|/\*.*?\*/", re.DOTALL)
#: A text in SQL.
_LITERAL: Final = re.compile(r"'(?:[^']|'')*'")
_AFTER_FROM: Final = re.compile(r'(?i:\b(?:from|join))\s+"?(\w+)')
_FIELD: Final = r"[A-Za-z_]\w*\.[A-Za-z_]\w*(?:\[\d+\])?"
_SHORT: Final = re.compile(
    rf"\s*(?P<fields>{_FIELD}(?:\s*,\s*{_FIELD})*)\s*(?:where\s+(?P<condition>.+?))?\s*",
    re.IGNORECASE | re.DOTALL,
)


def query_logs(
    logs: Sequence[Log], query: str, *, scaled: bool = False, enums: bool = False
) -> tuple[list[str], list[tuple[Any, ...]]]:
    """Ask logs a question.

    Args:
        logs: The logs, or views of them.
        query: SQL with messages as tables, or the short form.
        scaled: True gives values in the units of their schema.
        enums: True gives the names of enum values.

    Returns:
        Names of the columns, and the rows.

    Raises:
        InvalidArgumentError: The query is no valid SQL, or names a table or column that the logs lack.
        MissingExtraError: DuckDB or pyarrow is not installed.
        LogError: A log cannot be read.
    """
    duckdb = _duckdb()
    sql = expand_short_form(query) or query
    with duckdb.connect(":memory:") as connection:
        tables, sql = _tables_in(logs, sql)
        for alias, name in tables.items():
            connection.register(alias, _rows(logs, name, states_in(sql), scaled=scaled, enums=enums))
        # A query must not read or write other files, or read variables of this program.
        connection.execute("SET enable_external_access = false")
        connection.execute("SET python_enable_replacements = false")
        try:
            result = connection.execute(sql)
            if result.description is None:
                raise InvalidArgumentError("query failed: it gives no rows; write SELECT …")
            return _distinct([column[0] for column in result.description]), result.fetchall()
        except duckdb.Error as error:
            raise InvalidArgumentError(f"query failed: {_first_line(error)}") from error


def expand_short_form(query: str) -> str | None:
    """Return the SQL of a query in the short form, or None if it is not in that form.

    Args:
        query: The query.

    Returns:
        The SQL, or None.

    Raises:
        InvalidArgumentError: The fields belong to several messages.
    """
    found = _SHORT.fullmatch(query)
    if found is None:
        return None
    fields = [field.strip() for field in found["fields"].split(",")]
    tables = {field.partition(".")[0] for field in fields}
    if len(tables) > 1:
        raise InvalidArgumentError(
            f"query failed: the short form takes fields of one message, got {', '.join(sorted(tables))}; "
            "join messages in SQL"
        )
    columns = ", ".join(_column(field.partition(".")[2]) for field in fields)
    condition = f" WHERE {found['condition']}" if found["condition"] else ""
    return f'SELECT _time, {columns} FROM "{tables.pop()}"{condition}'  # noqa: S608 (the user's own query)


def _column(field: str) -> str:
    """Return the SQL of a field; SQL counts the elements of a list from 1."""
    name, bracket, index = field.partition("[")
    return f'"{name}"[{int(index.rstrip("]")) + 1}] AS "{field}"' if bracket else f'"{name}"'


def _tables_in(logs: Sequence[Log], sql: str) -> tuple[dict[str, str], str]:
    """Return the tables of the logs that a query names by their names in SQL, and the query with these."""
    words = set(_WORD.findall(_COMMENT.sub("", sql)))
    lower = {word.lower() for word in words}
    found: dict[str, str] = {}
    taken = {name.lower() for log in logs for name in log}
    for names in _equal_but_for_case(name for log in logs for name in log):
        exact = [name for name in names if name in words] if names[1:] else names
        if names[1:]:
            numbered = _numbered(names, taken)
            found |= {alias: name for alias, name in numbered.items() if alias in words}
        if names[0].lower() not in lower:
            continue
        if len(exact) > 1 and set(exact) <= set(_sources_in(sql)):
            aliases = {name: alias for alias, name in numbered.items() if name in exact}
            found |= {alias: name for name, alias in aliases.items()}
            sql = _with_aliases(sql, aliases)
            continue
        if len(exact) != 1:
            raise InvalidArgumentError(
                f"query failed: SQL does not distinguish the tables {' and '.join(names)}; "
                f"name them {' and '.join(numbered)}"
            )
        found[exact[0]] = exact[0]
    return found, sql


def _sources_in(sql: str) -> list[str]:
    """Return the words after FROM and JOIN."""
    code = "".join(_LITERAL.split(sql))
    return _AFTER_FROM.findall(code)


def _with_aliases(sql: str, aliases: Mapping[str, str]) -> str:
    """Return a query in which names of tables, as sources and before columns, are replaced."""
    names = "|".join(map(re.escape, aliases))
    place = re.compile(rf"((?i:\b(?:from|join)\s+)\"?)({names})(?![\w.])|(?<![\w.])()({names})(?=\"?\.)")

    def replaced(found: re.Match[str]) -> str:
        return (found[1] or "") + aliases[found[2] or found[4]]

    # Pieces with odd indexes are string literals.
    pieces = re.split(f"({_LITERAL.pattern})", sql)
    return "".join(piece if index % 2 else place.sub(replaced, piece) for index, piece in enumerate(pieces))


def _equal_but_for_case(names: Iterable[str]) -> Iterable[list[str]]:
    """Return names in groups of those that SQL does not distinguish."""
    groups: dict[str, list[str]] = {}
    for name in dict.fromkeys(names):
        groups.setdefault(name.lower(), []).append(name)
    return groups.values()


def _numbered(names: Sequence[str], taken: Collection[str]) -> dict[str, str]:
    """Return names that SQL distinguishes for names that it does not.

    Args:
        names: The names.
        taken: Names in lower case that others have.
    """
    found: dict[str, str] = {}
    number = 0
    for name in names:
        number += 1
        while f"{name}_{number}".lower() in taken:
            number += 1
        found[f"{name}_{number}"] = name
    return found


def states_in(sql: str) -> list[str]:
    """Return which of the columns `armed` and `mode` a query names."""
    words = set(_WORD.findall(sql.lower()))
    return [name for name in ("armed", "mode") if name in words]


def _rows(logs: Sequence[Log], name: str, states: Sequence[str], *, scaled: bool, enums: bool) -> Any:  # noqa: ANN401 (no types)
    """Return the rows of all logs as one Arrow table, with times in UTC and the states that are asked for."""
    pyarrow = import_module("pyarrow")
    pieces = []
    for log in logs:
        if name not in log:
            continue
        rows = log[name].to_arrow("lists", scaled=scaled, enums=enums)
        times = rows.column("_time").cast(pyarrow.timestamp("us"))
        rows = rows.set_column(rows.column_names.index("_time"), "_time", times)
        for state in states:
            if state not in {column.lower() for column in rows.column_names}:
                rows = rows.append_column(state, pyarrow.array(_states(log, name, state)))
        if len(logs) > 1:
            files = pyarrow.array([log.path.name]).dictionary_encode().take(pyarrow.array([0] * len(rows)))
            rows = rows.append_column("_file", files)
        pieces.append(_with_distinct_columns(rows.replace_schema_metadata(None)))
    try:
        return pyarrow.concat_tables(pieces, promote_options="permissive").combine_chunks()
    except pyarrow.ArrowException as error:
        raise LogError(f"query failed: {name} differs between the logs: {error}") from error


def _with_distinct_columns(rows: Any) -> Any:  # noqa: ANN401 (no types)
    """Return a table whose columns have a number behind their names if these differ in case only."""
    groups = [names for names in _equal_but_for_case(rows.column_names) if names[1:]]
    taken = {name.lower() for name in rows.column_names}
    new = {name: alias for names in groups for alias, name in _numbered(names, taken).items()}
    return rows.rename_columns([new.get(name, name) for name in rows.column_names]) if new else rows


def _states(log: Log, name: str, state: str) -> NDArray[Any]:
    """Return a state of the vehicle at each row of a table."""
    table, times = log[name], log.times(name)
    states = flight_states(log)
    systems = np.asarray(table["_system"]) if "_system" in (table.dtype.names or ()) else None
    values: NDArray[Any] = np.full(len(table), "" if state == "mode" else False, object)
    for system, each in states.items():
        rows = slice(None) if systems is None else systems == system
        values[rows] = getattr(each, state).at(times[rows])
    return values


def _distinct(names: Sequence[str]) -> list[str]:
    """Return the names of columns, with a number where SQL gives one name to several."""
    found: list[str] = []
    for name in names:
        text, number = name, 1
        while text in found:
            number += 1
            text = f"{name}_{number}"
        found.append(text)
    return found


def _duckdb() -> Any:  # noqa: ANN401 (optional)
    try:
        import_module("pyarrow")
        return import_module("duckdb")
    except ImportError:
        raise MissingExtraError("a query of logs", "data") from None


def _first_line(error: Exception) -> str:
    """Return the text of an error of DuckDB without the picture of the position."""
    return " ".join(line.strip() for line in str(error).split("\n\n")[0].splitlines() if line.strip())
