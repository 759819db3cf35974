"""The identity of a log in a dataset of many: its vehicle, its date, and a name of its own."""

from __future__ import annotations

import re
from hashlib import blake2b
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

_SAMPLE: Final = 1 << 16
_UNSAFE: Final = re.compile(r"[^A-Za-z0-9._-]+")
UNKNOWN_DATE: Final = "unknown"


def flight_name(log: Log) -> str:
    """Return a name for the files of a log: that of its file, and a hash of its size and content.

    The same file gives the same name on every machine, so that a repeated export replaces its files instead
    of adding the rows again.
    """
    digest = blake2b(str(log.size).encode(), digest_size=5)
    with log.path.open("rb") as file:
        digest.update(file.read(_SAMPLE))
        if log.size > 2 * _SAMPLE:
            file.seek(-_SAMPLE, 2)
        digest.update(file.read(_SAMPLE))
    return f"{_UNSAFE.sub('_', log.path.stem)[:80]}-{digest.hexdigest()}"


def flight_date(log: Log) -> str:
    """Return the UTC date on which a log begins, or "unknown"."""
    start = log.start
    return UNKNOWN_DATE if start is None or np.isnat(start) else str(start.astype("M8[D]"))


def by_vehicle(log: Log, tables: Mapping[str, MessageTable]) -> Iterator[tuple[int, str, MessageTable]]:
    """Yield the rows of each system apart: system id, name of the table, rows.

    A log that a vehicle writes itself has one system, whose id is that in its parameters or 0.
    """
    own = None
    for name, table in tables.items():
        if "_system" not in (table.dtype.names or ()):
            own = int(log.info.get("system", 0) or 0) if own is None else own
            yield own, name, table
            continue
        systems = np.unique(table["_system"])
        for system in systems.tolist():
            yield system, name, table if len(systems) == 1 else table.where(table["_system"] == system)
