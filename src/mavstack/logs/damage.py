"""Counts of the content of a file that could not be read: nothing is left out silently."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any


@dataclass(frozen=True, slots=True)
class LogDamage:
    """Counts of everything in a file that is in no table.

    Attributes:
        bad_bytes: Bytes outside of any record.
        bad_records: Damaged records that were recognised as such.
        truncated_bytes: Bytes of an incomplete record at the end of the file, not included in `bad_bytes`.
        unknown: Number of records of each id without a definition.
        other: Number of records left out for other reasons, by reason ("dropouts", "packets of other
            protocols").
    """

    bad_bytes: int = 0
    bad_records: int = 0
    truncated_bytes: int = 0
    unknown: Mapping[int, int] = field(default_factory=dict)
    other: Mapping[str, int] = field(default_factory=dict)

    @property
    def total(self) -> int:
        """Sum of all counts: 0 means that every byte of the file was read."""
        counts = (self.bad_bytes, self.bad_records, self.truncated_bytes)
        return sum(counts) + sum(self.unknown.values()) + sum(self.other.values())

    def __bool__(self) -> bool:
        return self.total > 0

    def to_dict(self) -> dict[str, Any]:
        """Return the counts as values that JSON can hold."""
        return {
            "bad_bytes": self.bad_bytes,
            "bad_records": self.bad_records,
            "truncated_bytes": self.truncated_bytes,
            "unknown": {str(number): count for number, count in self.unknown.items()},
            "other": dict(self.other),
            "total": self.total,
        }

    def describe(self) -> str:
        """Return one line of text such as "12 bad bytes, 3 records of unknown id 9000"."""
        parts = [
            _counted(self.bad_bytes, "bad byte"),
            _counted(self.bad_records, "damaged record"),
            _counted(self.truncated_bytes, "byte") + " of a truncated record" if self.truncated_bytes else "",
            *(
                f"{_counted(count, 'record')} of unknown id {number}"
                for number, count in self.unknown.items()
            ),
            *(f"{count:,} {reason}" for reason, count in self.other.items() if count),
        ]
        return ", ".join(part for part in parts if part) or "nothing skipped"


def _counted(count: int, noun: str) -> str:
    return f"{count:,} {noun}{'' if count == 1 else 's'}" if count else ""
