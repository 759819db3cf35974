"""MAT: one file of MATLAB's version 5, with a struct for each message and an array for each field.

The format holds at most 2 GiB for each variable, and is written from memory. Times are seconds since 1970 in
UTC; texts are character arrays.
"""

from __future__ import annotations

from collections import defaultdict
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.errors import MissingExtraError
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, PartFile, TableWriter
from mavstack.logs.time_base import unix_seconds

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

#: Longest name of a variable or field that MATLAB reads.
_MAX_NAME: Final = 63


class MatWriter(TableWriter):
    """Writes a MAT file."""

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        try:
            self._io = import_module("scipy.io")
        except ImportError:
            raise MissingExtraError("the export to MAT files", "mat") from None
        self._tables: dict[str, list[MessageTable]] = defaultdict(list)
        self._file = PartFile(path)

    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Keep the next rows; see `TableWriter.write`."""
        for name, table in tables.items():
            self._tables[name].append(table)

    def finish(self) -> list[Path]:
        """Write the file; see `ExportWriter.finish`."""
        names = _matlab_names(self._tables)
        content = {names[name]: self._struct(tables) for name, tables in self._tables.items()}
        with self._file.temporary.open("wb") as file:
            self._io.savemat(file, content, do_compression=True, long_field_names=True, oned_as="column")
        return [self._file.complete()]

    def discard(self) -> None:
        """Remove an incomplete file; see `ExportWriter.discard`."""
        self._file.discard()

    def _struct(self, tables: list[MessageTable]) -> dict[str, NDArray[Any]]:
        names = _matlab_names(tables[0].dtype.names or ())
        return {
            name: self._column([table[field] for table in tables], tables, field)
            for field, name in names.items()
        }

    def _column(self, pieces: list[NDArray[Any]], tables: list[MessageTable], field: str) -> NDArray[Any]:
        schema = tables[0].schema[field]
        if self.options.enums and schema.enum is not None:
            return np.concatenate([table.enum_names(field) for table in tables])
        column = np.concatenate([np.asarray(piece) for piece in pieces])
        if column.dtype.kind == "M":
            return unix_seconds(column)
        if column.dtype.kind == "S":
            return np.char.decode(column, "utf-8", "replace")
        if self.options.scaled and column.dtype.kind in "iuf":
            return np.concatenate([table.scaled(field) for table in tables])
        return column


def _matlab_names(names: Iterable[str]) -> dict[str, str]:
    """Return a distinct name that MATLAB accepts for each name."""
    found: dict[str, str] = {}
    used: set[str] = set()
    for name in names:
        valid, number = _matlab_name(name), 1
        while valid in used:
            number += 1
            valid = f"{_matlab_name(name)[: _MAX_NAME - 5]}_{number}"
        found[name] = valid
        used.add(valid)
    return found


def _matlab_name(name: str) -> str:
    """Return a name that MATLAB accepts: letters, digits and underscores, a letter first."""
    valid = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in name)
    if not valid[:1].isalpha():
        valid = f"f{valid}"
    return valid[:_MAX_NAME]


MAT: Final = LogExporter(
    "mat", "MATLAB file of version 5, a struct for each message", ".mat", False, MatWriter
)
