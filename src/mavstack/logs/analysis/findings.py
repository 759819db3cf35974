"""Findings: what a rule has found in a flight, with its numbers and the time to look at."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any


class Severity(IntEnum):
    """How grave a finding is; the highest is the gravest."""

    INFO = 0
    WARNING = 1
    CRITICAL = 2


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding of a rule.

    Attributes:
        rule: Name of the rule, such as "vibration".
        severity: How grave it is.
        title: One short line for a list.
        text: What was measured, what is usual, and what to do.
        time: Time to look at, in seconds from the beginning of the log; None if there is no single one.
        numbers: The measured values by name, with the unit in the name.
    """

    rule: str
    severity: Severity
    title: str
    text: str
    time: float | None = None
    numbers: Mapping[str, float] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the finding as values that JSON can hold."""
        return {
            "rule": self.rule,
            "severity": self.severity.name.lower(),
            "title": self.title,
            "text": self.text,
            "time_s": None if self.time is None else round(self.time, 3),
            "numbers": {name: round(float(value), 6) for name, value in self.numbers.items()},
        }
