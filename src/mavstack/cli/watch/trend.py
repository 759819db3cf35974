"""Trends of fields: the values of the last minute, as a line of small bars.

A pattern names fields as MESSAGE.FIELD, both with wildcards; MESSAGE alone stands for all its numeric fields.
Samples are taken at a fixed interval by the clock of the caller, so a column of the line is always as long. A
message that no longer arrives leaves a gap.
"""

from __future__ import annotations

from collections import deque
from fnmatch import fnmatchcase
from math import isfinite
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.field_values import field_texts
from mavstack.dialects.secrets import secret_fields

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from mavstack.cli.watch.observer import Observer
    from mavstack.cli.watch.traffic import Stream
    from mavstack.dialects import Dialect
    from mavstack.dialects.model import FieldDefinition

#: Seconds between two samples, and number of samples: together two minutes.
SAMPLE_INTERVAL: Final = 0.5
MAX_SAMPLES: Final = 240
#: Seconds for which a value is shown after its last packet.
MAX_AGE: Final = 3.0
MAX_TRENDS: Final = 200
_BARS: Final = "▁▂▃▄▅▆▇█"
_NO_QUANTITIES: Final = frozenset(
    {"time_boot_ms", "time_usec", "target_system", "target_component", "target_network"}
)

#: Label of the source, system id, component id, message name, and field name.
Key: TypeAlias = "tuple[str, int, int, str, str]"


class TrendRow(NamedTuple):
    """One field: its samples, oldest first (None: no value), and its newest value as text."""

    source: str
    name: str
    samples: Sequence[float | None]
    text: str


class FieldPatterns:
    """The numeric fields that the patterns of `--trend` name.

    Raises:
        UsageError: A pattern names no numeric field of the dialect.
    """

    def __init__(self, patterns: str, dialect: Dialect) -> None:
        words = [word.strip() for word in patterns.split(",") if word.strip()]
        self._dialect = dialect
        self._patterns = [_pattern(word) for word in words]
        self._fields: dict[str, list[str]] = {}
        for word, pattern in zip(words, self._patterns, strict=True):
            if not any(_fields(dialect, name, [pattern]) for name in dialect.names):
                example = "for example ATTITUDE.roll or 'VFR_HUD.*'"
                raise UsageError(f"--trend {word}: no message has such a numeric field; {example}")

    def fields(self, message: str) -> list[str]:
        """Return the named fields of a message, in their order."""
        if message not in self._fields:
            self._fields[message] = _fields(self._dialect, message, self._patterns)
        return self._fields[message]


class Trends:
    """The samples of the fields that the patterns name."""

    def __init__(self, patterns: FieldPatterns) -> None:
        self._patterns = patterns
        self._samples: dict[Key, tuple[deque[float | None], str]] = {}
        self._due = 0.0

    def sample(self, observers: Mapping[str, Observer], now: float) -> None:
        """Take a sample of each field, if one is due."""
        if now < self._due:
            return
        self._due = max(self._due + SAMPLE_INTERVAL, now)
        for samples, _ in self._samples.values():
            samples.append(None)
        for label, observer in observers.items():
            for (system, component, _), stream in observer.traffic.streams.items():
                if now - stream.time <= MAX_AGE:
                    self._sample_stream((label, system, component), stream)

    def rows(self) -> list[TrendRow]:
        """Return the fields by message, their order in it, and source."""
        return [
            TrendRow(f"{label} {system}/{component}".strip(), f"{name}.{field}", tuple(samples), text)
            for (label, system, component, name, field), (samples, text) in sorted(
                self._samples.items(), key=lambda item: self._order(item[0])
            )
        ]

    def _order(self, key: Key) -> tuple[str, int, tuple[str, int, int]]:
        label, system, component, name, field = key
        return name, self._patterns.fields(name).index(field), (label, system, component)

    def _sample_stream(self, source: tuple[str, int, int], stream: Stream) -> None:
        message, name = stream.packet.message, stream.packet.name
        if message is None or name is None:
            return
        fields = self._patterns.fields(name)
        if not fields:
            return
        texts = {each.name: each.text for each in field_texts(message)}
        for field in fields:
            self._add((*source, name, field), getattr(message, field, None), texts.get(field, ""))

    def _add(self, key: Key, value: object, text: str) -> None:
        entry = self._samples.get(key)
        if entry is None:
            if len(self._samples) >= MAX_TRENDS:
                return
            entry = deque([None], maxlen=MAX_SAMPLES), text
        entry[0][-1] = value if isinstance(value, int | float) and isfinite(value) else None
        self._samples[key] = entry[0], text


def _pattern(word: str) -> tuple[str, str]:
    message, _, field = word.partition(".")
    return message.upper(), field.lower() or "*"


def sparkline(samples: Sequence[float | None], width: int) -> str:
    """Return the last `width` samples as bars between their lowest and highest value."""
    shown = samples[-width:] if width > 0 else ()
    known = [value for value in shown if value is not None]
    low, span = min(known, default=0.0), max(known, default=0.0) - min(known, default=0.0)
    bars = "".join(" " if value is None else _bar((value - low) / span if span else 0.0) for value in shown)
    return bars.rjust(max(width, 0))


def _bar(share: float) -> str:
    return _BARS[min(int(share * len(_BARS)), len(_BARS) - 1)]


def _fields(dialect: Dialect, name: str, patterns: Iterable[tuple[str, str]]) -> list[str]:
    """Return the numeric fields of a message that one of the patterns names."""
    chosen = [field for message, field in patterns if fnmatchcase(name.upper(), message)]
    if not chosen:
        return []
    return [
        field.name
        for field in dialect[name].definition.fields
        if _is_quantity(field, name) and any(fnmatchcase(field.name, pattern) for pattern in chosen)
    ]


def _is_quantity(field: FieldDefinition, message: str) -> bool:
    """Return whether a field is one number with a course: no text, enum, time, target or secret."""
    return not (
        field.array_length
        or field.enum
        or field.type == "char"
        or field.name in _NO_QUANTITIES
        or field.name in secret_fields(message)
    )
