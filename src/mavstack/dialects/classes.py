"""Creation of message classes from table rows."""

from __future__ import annotations

from mavstack._core import MessageMeta, new_message_class
from mavstack.dialects.message import Message
from mavstack.dialects.names import class_name, to_identifier
from mavstack.dialects.secrets import secret_fields

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import Any

    from mavstack.dialects.dialect import Dialect
    from mavstack.dialects.tables import MessageRow, Table

#: Names that fields may not have, because they are attributes of all messages.
_RESERVED_NAMES = frozenset(dir(Message))
#: The field with the version of the dialect that the sender uses.
_VERSION_FIELD = "mavlink_version"


def attribute_names(row: MessageRow) -> list[str]:
    """Return the attribute names of a message's fields; a reserved name gets a trailing `_`."""
    names: list[str] = []
    for field in row[5]:
        name = to_identifier(field[0])
        while name in _RESERVED_NAMES or name in names:
            name += "_"
        names.append(name)
    return names


def make_class(
    dialect: Dialect, row: MessageRow, parents: Sequence[type[Message]], table: Table
) -> type[Message]:
    """Create the class of a message in `dialect`; `table` is that of the file that defines the message."""
    attributes = attribute_names(row)
    metadata, field_metadata = table.message_metadata(row[1])
    namespace: dict[str, Any] = {
        "__slots__": (),
        "__module__": dialect.module_name,
        "__doc__": metadata.get("description"),
        "__match_args__": tuple(attributes),
        "__mavlink_dialect__": dialect,
        "__mavlink_row__": row,
    }
    bases = _bases(parents) or (Message,)
    namespace |= _absent_fields(parents, attributes)
    template = _version_template(row, field_metadata, table.header["version"])
    message_class: Any = new_message_class(
        class_name(row[1]), bases, namespace, dialect.layout(row), template, _json_members(row)
    )
    return message_class  # type: ignore[no-any-return]


def _json_members(row: MessageRow) -> list[tuple[str, bool]]:
    """Return the name of each field in JSON, and whether its value is hidden."""
    secret = secret_fields(row[1])
    return [(field[0], field[0] in secret) for field in row[5]]


def _version_template(row: MessageRow, field_metadata: dict[str, Any], version: int | None) -> bytes | None:
    """Return the default payload of a message whose version field has the version of the definitions."""
    if not field_metadata.get(_VERSION_FIELD, {}).get("protocol_version"):
        return None
    offset = next(int(field[3]) for field in row[5] if field[0] == _VERSION_FIELD)
    return bytes(offset) + bytes([version or 0])


def _bases(parents: Iterable[type[Message]]) -> tuple[type[Message], ...]:
    """Return as many of the parents, from the first, as Python can combine in one class."""
    bases = tuple(_leaf_classes(parents))
    while len(bases) > 1:
        try:
            MessageMeta("probe", bases, {"__slots__": ()})
        except TypeError:
            # the base classes have no consistent order: two files include the same files in different orders
            bases = bases[:-1]
        else:
            break
    return bases


def _leaf_classes(classes: Iterable[type[Message]]) -> list[type[Message]]:
    """Return the classes that are not base classes of another one."""
    unique = list(dict.fromkeys(classes))
    return [
        item for item in unique if not any(other is not item and issubclass(other, item) for other in unique)
    ]


def _absent_fields(bases: Iterable[type[Message]], attributes: Sequence[str]) -> dict[str, property]:
    """Return properties for the extension fields that only a parent has: they read as zero."""
    return {
        name: _constant(getattr(base.from_payload(b""), name))
        for base in bases
        for name in base.__match_args__
        if name not in attributes
    }


def _constant(value: object) -> property:
    return property(lambda _message: value)


def official_bases(row: MessageRow, dialects: Iterable[Dialect]) -> list[type[Message]]:
    """Return the official class with the same id, name and layout except extensions, as a list."""
    for dialect in dialects:
        if row[1] in dialect and row[0] in dialect:
            official = dialect[row[0]]
            if official.__mavlink_row__[1:4] == row[1:4]:
                return [official]
    return []
