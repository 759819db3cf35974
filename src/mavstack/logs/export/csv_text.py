"""Texts in CSV files, which spreadsheets would run as formulas.

A spreadsheet takes a cell as a formula if it begins with `=`, `@`, `+` or `-`. The texts of a log come from a
vehicle, or from any program that reached it, so a formula in one of them would run on the machine of the
analyst. An apostrophe before the text makes it a text. Numbers with a sign stay as they are.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any, Final

#: First characters of formulas, with the wide forms that spreadsheets also accept. A text with a leading sign
#: may also be a number.
_FORMULA: Final = "^[=@\t\r＝＠＋－+-]"  # noqa: RUF001 (the wide characters)
_NUMBER: Final = "[+-]?([0-9]+([.][0-9]*)?|[.][0-9]+)([eE][+-]?[0-9]+)?|[+-](inf|nan)"
_IS_FORMULA: Final = re.compile(_FORMULA)
_IS_NUMBER: Final = re.compile(_NUMBER, re.IGNORECASE)


def escape_formula(value: object) -> object:
    """Return a cell that no spreadsheet takes as a formula.

    Args:
        value: The value of the cell.

    Returns:
        A text with an apostrophe before it if it begins a formula, and any other value unchanged.
    """
    if not isinstance(value, str) or not _IS_FORMULA.match(value) or _IS_NUMBER.fullmatch(value):
        return value
    return f"'{value}"


def escape_columns(table: Any) -> Any:  # noqa: ANN401 (pyarrow has no types)
    """Return an Arrow table whose texts and names of columns are escaped by `escape_formula`."""
    pyarrow = import_module("pyarrow")
    for index, field in enumerate(table.schema):
        column = table.column(index)
        if pyarrow.types.is_dictionary(field.type):
            column = column.cast(field.type.value_type)
        if pyarrow.types.is_string(column.type) or pyarrow.types.is_large_string(column.type):
            table = table.set_column(index, field.name, _escaped(column))
    return table.rename_columns([str(escape_formula(name)) for name in table.column_names])


def sql_of_column(name: str) -> str:
    """Return the SQL of DuckDB for a column of texts that is escaped."""
    formula, number = (text.replace("'", "''") for text in (_FORMULA, f"(?i){_NUMBER}"))
    return (
        f"CASE WHEN regexp_matches({name}, '{formula}') AND NOT regexp_full_match({name}, '{number}') "
        f"THEN '''' || {name} ELSE {name} END AS {name}"
    )


def _escaped(column: Any) -> Any:  # noqa: ANN401 (as above)
    compute = import_module("pyarrow.compute")
    is_formula = compute.match_substring_regex(column, _FORMULA)
    is_number = compute.match_substring_regex(column, f"(?i)^({_NUMBER})$")
    chosen = compute.and_not(is_formula, is_number)
    if not compute.any(chosen).as_py():
        return column
    marked = compute.binary_join_element_wise("'", column, "")
    return compute.if_else(chosen, marked, column)
