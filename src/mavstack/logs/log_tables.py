"""The tables of a log by name, decoded on first access and kept until the cache is cleared."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import UnknownMessageError
from mavstack.logs.message_table import MessageTable
from mavstack.logs.table_text import suggestion

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path
    from typing import Self

    from mavstack.logs.schema import TableSchema

_INSTANCE: Final = re.compile(r"(?P<name>.+)\[(?P<instance>\d+)\]")


class LogTables(Mapping[str, MessageTable]):
    """A mapping from names to tables.

    Attributes:
        path: Path of the file.
        format: Name of the format: "tlog", "raw", "dataflash" …
        size: Size of the file in bytes.
    """

    format: str = ""

    def __init__(self, path: Path, size: int) -> None:
        self.path = path
        self.size = size
        self._tables: dict[str, MessageTable] = {}

    # what a format implements

    @property
    @abstractmethod
    def counts(self) -> Mapping[str, int]:
        """Number of rows by table name."""

    @abstractmethod
    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a table, without decoding the table.

        Args:
            name: Name of the table.

        Returns:
            Units, multipliers, enums and descriptions of all columns.

        Raises:
            UnknownMessageError: The log has no table of that name.
        """

    @abstractmethod
    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables that the log has, in one pass."""

    # the mapping

    def __getitem__(self, name: str) -> MessageTable:
        if name not in self._tables:
            if name not in self.counts and (found := _INSTANCE.fullmatch(name)):
                return self._instance(found["name"], int(found["instance"]))
            self.load(name)
        return self._tables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.counts)

    def __len__(self) -> int:
        return len(self.counts)

    def __contains__(self, name: object) -> bool:
        return name in self.counts

    def _instance(self, name: str, instance: int) -> MessageTable:
        table = self[name]
        field = table.schema.instance_field
        if not field:
            raise UnknownMessageError(f"{self.path}: {name} has no instances")
        selected = table.where(table[field] == instance)
        if not len(selected):
            known = ", ".join(map(str, np.unique(table[field]).tolist()))
            raise UnknownMessageError(f"{self.path} contains no {name}[{instance}]; instances: {known}")
        return selected

    def _require(self, names: Sequence[str]) -> list[str]:
        """Return the names without duplicates, or all names without any; raises if the log lacks one."""
        for name in names:
            if name not in self.counts:
                close = suggestion(name, self)
                raise UnknownMessageError(
                    f"{self.path} contains no {name}{close}; it contains {', '.join(self)}"
                )
        return list(dict.fromkeys(names or self))

    def load(self, *names: str) -> None:
        """Decode several tables in one pass, which is faster than one after the other.

        Args:
            names: The names; without names all tables are decoded.

        Raises:
            UnknownMessageError: The log has no table of that name.
            LogError: The file was truncated or rewritten since it was opened.
        """
        missing = [name for name in self._require(names) if name not in self._tables]
        self._tables.update(self.decode_tables(missing))

    def clear_cache(self, name: str | None = None) -> None:
        """Drop decoded tables, which are decoded again on the next access.

        Args:
            name: The name; None for all tables.
        """
        if name is None:
            self._tables.clear()
        else:
            self._tables.pop(name, None)

    def close(self) -> None:
        """Release the decoded tables and other resources; a later access takes them again. Idempotent."""
        self.clear_cache()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
