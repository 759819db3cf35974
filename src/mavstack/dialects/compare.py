"""Comparison of two dialects, marking the differences that break communication.

A message whose id, CRC_EXTRA or base length differs cannot be read by a peer with the other definition; with
an added extension field or a new enum entry it can.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, TypeVar

from mavstack.dialects.model import EnumParam, Replacement

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.dialects.model import (
        DialectDefinition,
        EnumDefinition,
        EnumEntry,
        FieldDefinition,
        MessageDefinition,
    )

Kind: TypeAlias = Literal["added", "removed", "changed"]
_Value = TypeVar("_Value")

_NOT_COMPARED = frozenset(
    {"fields", "entries", "crc_extra", "base_length", "length", "origin", "offset", "line"}
)
_PROSE = frozenset({"description"})


@dataclass(frozen=True, slots=True)
class Change:
    """One difference between two dialects.

    Attributes:
        kind: `added`, `removed` or `changed`.
        subject: The definition, such as `message ATTITUDE`.
        detail: The old and the new value as text.
        breaks_wire: True if peers with the other definition cannot read the message.
    """

    kind: Kind
    subject: str
    detail: str = ""
    breaks_wire: bool = False

    def __str__(self) -> str:
        detail = f": {self.detail}" if self.detail else ""
        return f"{self.kind} {self.subject}{detail}{' (breaks the wire)' if self.breaks_wire else ''}"


def compare(old: DialectDefinition, new: DialectDefinition, *, prose: bool = False) -> list[Change]:
    """Compare two dialects.

    Args:
        old: The old definition.
        new: The new definition.
        prose: True to compare descriptions too.

    Returns:
        The differences: messages first, then enums, by name.
    """
    ignored = _NOT_COMPARED if prose else _NOT_COMPARED | _PROSE
    return [*_messages(old, new, ignored), *_enums(old, new, ignored)]


def _pairs(
    subject: str, old: Mapping[str, _Value], new: Mapping[str, _Value]
) -> Iterator[Change | tuple[_Value, _Value]]:
    """Yield a change for each name that only one side has, and a pair for each common name, in order."""
    for name in sorted(old.keys() | new.keys()):
        if name not in new:
            yield Change("removed", f"{subject}{name}")
        elif name not in old:
            yield Change("added", f"{subject}{name}")
        else:
            yield old[name], new[name]


def _changed_attributes(
    subject: str, old: NamedTuple, new: NamedTuple, ignored: frozenset[str]
) -> Iterator[Change]:
    """Yield the changed attributes of one definition."""
    for name in old._fields:
        if name not in ignored:
            yield from _changed_attribute(subject, name, getattr(old, name), getattr(new, name), ignored)


def _changed_attribute(
    subject: str, name: str, before: object, after: object, ignored: frozenset[str]
) -> Iterator[Change]:
    if ignored >= _PROSE:
        before, after = _without_prose(before), _without_prose(after)
    if before != after:
        yield Change("changed", subject, f"{name} {_format(before)} -> {_format(after)}")


def _without_prose(value: object) -> object:
    """Remove the description of a deprecation or of the parameters of a command."""
    if isinstance(value, Replacement | EnumParam):
        return value._replace(description="")
    return tuple(map(_without_prose, value)) if isinstance(value, tuple) else value


def _format(value: object) -> str:
    """Format a value for the detail of a change."""
    if isinstance(value, Replacement | EnumParam):
        return " ".join(str(part) for part in value if part not in ("", None, False))
    if isinstance(value, tuple):
        return f"({', '.join(map(_format, value))})"
    return "nothing" if value in ("", None) else str(value)


def _messages(old: DialectDefinition, new: DialectDefinition, ignored: frozenset[str]) -> Iterator[Change]:
    for pair in _pairs("message ", old.messages_by_name, new.messages_by_name):
        if isinstance(pair, Change):
            yield pair
        else:
            yield from _message(*pair, ignored)


def _message(old: MessageDefinition, new: MessageDefinition, ignored: frozenset[str]) -> Iterator[Change]:
    subject = f"message {old.name}"
    if old.id != new.id:
        yield Change("changed", subject, f"id {old.id} -> {new.id}", breaks_wire=True)
    if (old.crc_extra, old.base_length) != (new.crc_extra, new.base_length):
        detail = f"CRC_EXTRA {old.crc_extra} -> {new.crc_extra}"
        yield Change("changed", subject, detail, breaks_wire=True)
    yield from _changed_attributes(subject, old, new, ignored | {"id"})
    for pair in _pairs(f"field {old.name}.", old.by_name, new.by_name):
        if isinstance(pair, Change):
            yield pair
        else:
            yield from _field(old.name, *pair, ignored)
            yield from _extension_offset(old, new, *pair)


def _field(
    message: str, old: FieldDefinition, new: FieldDefinition, ignored: frozenset[str]
) -> Iterator[Change]:
    subject = f"field {message}.{old.name}"
    for change in _changed_attributes(subject, old, new, ignored):
        breaks_wire = change.detail.startswith(("type ", "array_length ", "extension "))
        yield Change("changed", subject, change.detail, breaks_wire=breaks_wire)


def _extension_offset(
    old: MessageDefinition, new: MessageDefinition, before: FieldDefinition, after: FieldDefinition
) -> Iterator[Change]:
    """Yield a change if an extension has another offset, which CRC_EXTRA does not detect."""
    old_offset, new_offset = before.offset - old.base_length, after.offset - new.base_length
    if before.extension and after.extension and old_offset != new_offset:
        yield Change(
            "changed",
            f"field {old.name}.{before.name}",
            f"offset {old_offset} -> {new_offset} in the extensions",
            breaks_wire=True,
        )


def _enums(old: DialectDefinition, new: DialectDefinition, ignored: frozenset[str]) -> Iterator[Change]:
    for pair in _pairs("enum ", old.enums_by_name, new.enums_by_name):
        if isinstance(pair, Change):
            yield pair
        else:
            yield from _enum(*pair, ignored)


def _enum(old: EnumDefinition, new: EnumDefinition, ignored: frozenset[str]) -> Iterator[Change]:
    yield from _changed_attributes(f"enum {old.name}", old, new, ignored)
    for pair in _pairs(f"entry {old.name}.", _by_name(old), _by_name(new)):
        if isinstance(pair, Change):
            yield pair
        else:
            before, after = pair
            yield from _changed_attributes(f"entry {old.name}.{before.name}", before, after, ignored)


def _by_name(enum: EnumDefinition) -> dict[str, EnumEntry]:
    return {entry.name: entry for entry in enum.entries}
