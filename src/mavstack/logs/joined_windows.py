"""Whole tables from the windows of a log: for logs whose file is read piece by piece."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.errors import LogError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from mavstack.logs.message_table import MessageTable


def join_windows(
    path: Path, counts: Mapping[str, int], windows: Iterable[Mapping[str, MessageTable]]
) -> dict[str, MessageTable]:
    """Return the tables whose rows the windows of a log hold.

    Args:
        path: Path of the log, for errors.
        counts: Number of rows of each table, none of them 0.
        windows: The rows of these tables, piece by piece.

    Returns:
        The tables.

    Raises:
        LogError: The windows hold other numbers of rows.
    """
    tables: dict[str, MessageTable] = {}
    done = dict.fromkeys(counts, 0)
    for window in windows:
        for name, rows in window.items():
            if name not in tables:
                tables[name] = np.empty_like(rows, shape=counts[name])
            begin, done[name] = done[name], done[name] + len(rows)
            if done[name] > counts[name]:
                raise _rewritten(path)
            _bytes(tables[name])[begin : done[name]] = _bytes(rows)
    if done != counts:
        raise _rewritten(path)
    return tables


def _bytes(table: MessageTable) -> NDArray[np.uint8]:
    """Return the bytes of each row: numpy copies rows with fields one field after the other."""
    return np.asarray(table).view(np.uint8).reshape(len(table), table.dtype.itemsize)


def _rewritten(path: Path) -> LogError:
    return LogError(f"cannot read {path}: it was rewritten since it was opened; open it again")
