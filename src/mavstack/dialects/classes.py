"""Message classes out of table rows."""

from __future__ import annotations

from mavstack._core import MessageMeta, new_message_class
from mavstack.dialects.message import Message
from mavstack.dialects.names import class_name, usable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import Any

    from mavstack.dialects.dialect import Dialect
    from mavstack.dialects.tables import MessageRow, Table

#: What a field may not be called, because messages have it for themselves.
_TAKEN = frozenset(dir(Message))
#: The field that a sender fills with the version of its definitions.
_VERSION_FIELD = "mavlink_version"


def attribute_names(row: MessageRow) -> list[str]:
    """The Python attributes of a message's fields; a name that is taken gets a trailing `_`."""
    names: list[str] = []
    for field in row[5]:
        name = usable(field[0])
        while name in _TAKEN or name in names:
            name += "_"
        names.append(name)
    return names


def make_class(
    dialect: Dialect, row: MessageRow, parents: Sequence[type[Message]], table: Table
) -> type[Message]:
    """The class of a message as `dialect` sees it; `table` is of the file that defines the message."""
    attributes = attribute_names(row)
    facts, field_facts = table.message_facts(row[1])
    namespace: dict[str, Any] = {
        "__slots__": (),
        "__module__": dialect.module_name,
        "__doc__": facts.get("description"),
        "__match_args__": tuple(attributes),
        "__mavlink_dialect__": dialect,
        "__mavlink_row__": row,
    }
    bases = _bases(parents) or (Message,)
    namespace |= _absent_fields(parents, attributes)
    template = _version_template(row, field_facts, table.header["version"])
    made: Any = new_message_class(class_name(row[1]), bases, namespace, dialect.layout(row), template)
    return made  # type: ignore[no-any-return]


def _version_template(row: MessageRow, field_facts: dict[str, Any], version: int | None) -> bytes | None:
    """The payload of a message whose version field names its definitions' version unless told otherwise."""
    if not field_facts.get(_VERSION_FIELD, {}).get("protocol_version"):
        return None
    offset = next(int(field[3]) for field in row[5] if field[0] == _VERSION_FIELD)
    return bytes(offset) + bytes([version or 0])


def _bases(parents: Iterable[type[Message]]) -> tuple[type[Message], ...]:
    """As many of the parents, the first ones first, as Python can derive one class from."""
    bases = tuple(_least(parents))
    while len(bases) > 1:
        try:
            MessageMeta("probe", bases, {"__slots__": ()})
        except TypeError:  # files that include the same two in different orders
            bases = bases[:-1]
        else:
            break
    return bases


def _least(classes: Iterable[type[Message]]) -> list[type[Message]]:
    """The classes without those that others of them derive from."""
    unique = list(dict.fromkeys(classes))
    return [
        item for item in unique if not any(other is not item and issubclass(other, item) for other in unique)
    ]


def _absent_fields(bases: Iterable[type[Message]], attributes: Sequence[str]) -> dict[str, property]:
    """Extension fields that a parent has and this version has not: they read as zero, as when not sent."""
    return {
        name: _constant(getattr(base.from_payload(b""), name))
        for base in bases
        for name in base.__match_args__
        if name not in attributes
    }


def _constant(value: object) -> property:
    return property(lambda _message: value)


def counterpart(row: MessageRow, dialects: Iterable[Dialect]) -> list[type[Message]]:
    """The official class that a user's message can stand for: the same on the wire but for extensions."""
    for dialect in dialects:
        if row[1] in dialect and row[0] in dialect:
            official = dialect[row[0]]
            if official.__mavlink_row__[1:4] == row[1:4]:
                return [official]
    return []
