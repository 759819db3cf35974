"""A table as text: a line for each column, with its type, its unit, its first values and its last one."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

#: Number of rows from the beginning that are shown.
_FIRST: Final = 3
#: Maximum length of the text of a value.
_MAX_TEXT: Final = 24
_DIGITS: Final = 6


def table_text(
    name: str, columns: Mapping[str, np.ndarray[Any, np.dtype[Any]]], units: Mapping[str, str]
) -> str:
    """Return the columns of a table with a few of its rows, as `print(table)` shows it.

    Args:
        name: The name of its records; empty: they have none.
        columns: The columns by name, of equal length.
        units: The units of columns by name.
    """
    count = len(next(iter(columns.values()), ()))
    shown = [*range(min(_FIRST, count)), *([count - 1] if count > _FIRST else [])]
    heads = ["first" if index == 0 else "" for index in range(len(shown))]
    if len(shown) > _FIRST:
        heads[-1] = "last"
    rows = [["field", "type", "unit", *heads]]
    for field, column in columns.items():
        rows.append([field, _type_of(column), units[field], *[_value(column[index]) for index in shown]])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    title = f"{name}: {count} rows" if name else f"{count} rows"
    return "\n".join([title, *(line.rstrip() for line in lines)])


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean NAME?` if a known name is like a misspelt one, else an empty text."""
    names = {each.lower(): each for each in known}
    near = get_close_matches(name.lower(), names, 1)
    return f"; did you mean {names[near[0]]}?" if near else ""


def _type_of(column: np.ndarray[Any, np.dtype[Any]]) -> str:
    length = f"[{column.shape[1]}]" if column.ndim > 1 else ""
    kind = {"S": "text", "U": "text", "O": "text", "M": "time"}.get(column.dtype.kind, column.dtype.name)
    return f"{kind}{length}"


def _value(value: Any) -> str:  # noqa: ANN401 (any element of a table)
    if isinstance(value, np.ndarray):
        text = f"[{' '.join(_value(each) for each in value)}]"
    elif isinstance(value, bytes):
        text = value.decode("utf-8", "replace")
    elif isinstance(value, np.datetime64):
        text = str(value.astype("datetime64[ms]"))
    elif isinstance(value, np.floating):
        text = f"{float(value):.{_DIGITS}g}"
    else:
        text = str(value)
    text = "".join(each if each.isprintable() else "·" for each in text)
    return text if len(text) <= _MAX_TEXT else f"{text[: _MAX_TEXT - 1]}…"
