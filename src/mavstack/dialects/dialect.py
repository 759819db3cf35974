"""A dialect as programs use it: message and enum classes by name and id, made on first use.

A class belongs to the file that defines it, so `ardupilotmega.Attitude` is `common.Attitude`. Where a
dialect adds entries to an enum (as ardupilotmega does to MAV_CMD) it has an enum class of its own, and
each message with such a field has a subclass that reads as the larger enum; a packet read by the one still
matches the class of the other. The messages of a user's files are subclasses of the official ones wherever
they mean the same on the wire, so that programs written for `common` work with any version of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache, cached_property, lru_cache

from mavstack._core import Dialect as CoreDialect
from mavstack.dialects.classes import attribute_names, counterpart, make_class
from mavstack.dialects.enums import EnumClass, make_enum, reserved_names
from mavstack.dialects.names import class_name, member_names
from mavstack.dialects.tables import MessageRow, Table, load_table, official_name, official_names
from mavstack.errors import UnknownMessageError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from os import PathLike
    from typing import Any

    from mavstack._core import FieldLayout, MessageLayout
    from mavstack.dialects.includes import Source
    from mavstack.dialects.message import Message
    from mavstack.dialects.model import DialectDefinition, EnumDefinition, MessageDefinition

_INTEGERS_ONLY = ("float", "double", "char")


class Dialect:
    """The messages and enums of one definition file and of all that it includes."""

    def __init__(self, table: Table, includes: Iterable[Dialect], path: str = "") -> None:
        self.table = table
        self.includes = tuple(includes)
        self.path = path
        self._classes: dict[int, type[Message]] = {}
        self._enum_classes: dict[str, EnumClass] = {}
        self.definitions: dict[int, MessageDefinition] = {}
        self.enums: Mapping[str, EnumClass] = EnumMapping(self)

    @classmethod
    def load(cls, name: str) -> Dialect:
        """An official dialect by its name, such as `common`, in any case."""
        return _load(official_name(name))

    @classmethod
    def from_xml(cls, path: str | PathLike[str]) -> Dialect:
        """The dialect in a MAVLink XML file; an unchanged file gives the same dialect again."""
        from mavstack.dialects.includes import collect

        return _from_source(collect(str(path)))

    # what it is

    @property
    def name(self) -> str:
        """The name of the file, without `.xml`."""
        return self.table.name

    @property
    def version(self) -> int | None:
        """The `<version>` of the file, or of the first included file that has one."""
        versions = (dialect.table.header["version"] for dialect in reversed(self.family))
        return next((int(version) for version in versions if version is not None), None)

    @property
    def module_name(self) -> str:
        """The module that its classes say they are in."""
        return self.path or f"mavstack.dialects.{self.name.lower()}"

    @cached_property
    def family(self) -> tuple[Dialect, ...]:
        """All dialects it is made of, the included ones first, itself last."""
        found = {id(item): item for dialect in self.includes for item in dialect.family}
        return (*found.values(), self)

    @cached_property
    def core_dialect(self) -> CoreDialect:
        """The layout tables of all messages, for parsers."""
        rows = [row for dialect in self.family for row in dialect.table.rows]
        return CoreDialect(self.name, [self.layout(row) for row in rows], self.message_class)

    @property
    def dialect(self) -> Dialect:
        """Itself, as a dialect module has it."""
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """The official names of all messages."""
        return tuple(self._ids)

    @cached_property
    def definition(self) -> DialectDefinition:
        """All that is said about its messages and enums, included ones too."""
        from mavstack.dialects.codec import decode_table
        from mavstack.dialects.includes import merge_definitions

        return merge_definitions([decode_table(dialect.table) for dialect in self.family])

    @cached_property
    def own_definition(self) -> DialectDefinition:
        """What the file says itself."""
        from mavstack.dialects.codec import decode_table

        return decode_table(self.table)

    # messages

    @cached_property
    def _ids(self) -> dict[str, int]:
        return {name: number for dialect in self.family for name, number in dialect.table.ids.items()}

    @cached_property
    def _origins(self) -> dict[int, Dialect]:
        return {number: dialect for dialect in self.family for number in dialect.table.ids.values()}

    def name_of(self, number: int) -> str:
        """The official name of a message by its id, without making its class."""
        return str(self.row(number)[1])

    def row(self, number: int) -> MessageRow:
        """A message's row in the table that it comes from."""
        return self._origins[number].table.row(number)

    def __getitem__(self, key: str | int) -> type[Message]:
        number = self._ids.get(key) if isinstance(key, str) else key
        if number is None or number not in self._origins:
            kind = "called" if isinstance(key, str) else "with id"
            raise UnknownMessageError(f"dialect {self.name} has no message {kind} {key}")
        return self.message_class(number)

    def __contains__(self, key: object) -> bool:
        return key in self._ids or key in self._origins

    def __iter__(self) -> Iterator[type[Message]]:
        return map(self.message_class, tuple(self._origins))

    def __len__(self) -> int:
        return len(self._origins)

    def __repr__(self) -> str:
        return f"<Dialect {self.name}: {len(self)} messages>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Dialect.from_xml, (self.path,)) if self.path else (Dialect.load, (self.name,))

    def layout(self, row: MessageRow) -> MessageLayout:
        """A message as the core wants it."""
        number, name, crc_extra, base_length, length, fields = row
        attributes = attribute_names(row) if self.path else None
        layouts: list[FieldLayout] = [
            (
                attributes[index] if attributes else field,
                kind,
                count,
                offset,
                bool(enum) and kind not in _INTEGERS_ONLY,
            )
            for index, (field, kind, count, offset, enum) in enumerate(fields)
        ]
        return number, name, crc_extra, base_length, length, layouts

    def message_class(self, number: int) -> type[Message]:
        """The class of a message by its id, which must be known."""
        made = self._classes.get(number)
        if made is None:
            owner = self._owner(number)
            made = owner.message_class(number) if owner is not self else self._make_class(number)
            made = self._classes.setdefault(number, made)
        return made

    def _owner(self, number: int) -> Dialect:
        """The first dialect of the family for which the message means what it means here."""
        enums = {field[4] for field in self.row(number)[5] if field[4]}
        origin = self._origins[number]
        owners = {enum: self.enum_owner(enum) for enum in enums}
        for dialect in self.family:
            if origin in dialect.family and all(dialect.enum_owner(enum) is owners[enum] for enum in enums):
                return dialect
        return self

    def _make_class(self, number: int) -> type[Message]:
        row = self.row(number)
        parents = [dialect.message_class(number) for dialect in self.includes if number in dialect]
        if self.path:
            parents += counterpart(row, self._official_views())
        table = self._origins[number].table
        return make_class(self, row, parents, table)

    def _official_views(self) -> list[Dialect]:
        """Official dialects in which a user's message may be known, the namesake first."""
        names = [name for name in official_names() if name.lower() == self.name.lower()]
        return [Dialect.load(name) for name in dict.fromkeys([*names, "common"])]

    def message_definition(self, number: int) -> MessageDefinition:
        """All that is said about a message."""
        from mavstack.dialects.codec import decode_message

        origin = self._origins[number]
        if number not in origin.definitions:
            origin.definitions[number] = decode_message(self.row(number), origin.table)
        return origin.definitions[number]

    # enums

    @cached_property
    def enum_files(self) -> dict[str, tuple[Dialect, ...]]:
        """The dialects that each enum's entries come from."""
        files: dict[str, list[Dialect]] = {}
        for dialect in self.family:
            for name in dialect.table.enum_names:
                files.setdefault(name, []).append(dialect)
        return {name: tuple(dialects) for name, dialects in files.items()}

    def enum_owner(self, name: str) -> Dialect:
        """The first dialect of the family that has the same entries."""
        files = self.enum_files[name]
        if len(files) == 1:
            return files[0]
        return next(dialect for dialect in self.family if dialect.enum_files.get(name) == files)

    def enum_class(self, name: str) -> EnumClass:
        """The class of an enum by its official name."""
        made = self._enum_classes.get(name)
        if made is None:
            owner = self.enum_owner(name)
            made = owner.enum_class(name) if owner is not self else self._make_enum(name)
            made = self._enum_classes.setdefault(name, made)
        return made

    def _make_enum(self, name: str) -> EnumClass:
        entries, bitmask = self._enum_entries(name)
        bitmask = bitmask and all(value >= 0 for rows in entries for value, _, _ in rows)
        origin, *others = ([entry for _, entry, _ in rows] for rows in entries)
        added = [entry for names in others for entry in names if entry not in origin]
        python_names = member_names(name, origin, added, reserved_names(bitmask))
        members = {python_names[entry]: value for rows in entries for value, entry, _ in rows}
        made = class_name(name)
        made = f"{made}Enum" if made in self.messages_by_class else made
        return make_enum(self, name, made, members, bitmask=bitmask)

    def _enum_entries(self, name: str) -> tuple[list[list[list[Any]]], bool]:
        """The entries [value, name, facts] that each file gives an enum, and whether it is a bitmask."""
        rows = [dialect.table.enum_row(name) for dialect in self.enum_files[name]]
        return [entries for _, entries in rows], any(facts.get("bitmask", False) for facts, _ in rows)

    def enum_values(self, name: str) -> dict[str, int]:
        """The values of an enum by the official names of its entries."""
        return {entry: value for rows in self._enum_entries(name)[0] for value, entry, _ in rows}

    def enum_definition(self, name: str) -> EnumDefinition:
        """All that is said about an enum, additions by included files too."""
        from mavstack.dialects.codec import decode_enum
        from mavstack.dialects.includes import merge_enum

        first, *others = (decode_enum(name, dialect.table) for dialect in self.enum_files[name])
        for more in others:
            first = merge_enum(first, more, self.path or self.name)
        return first

    # Python names

    @cached_property
    def messages_by_class(self) -> dict[str, str]:
        """Official names of the messages by the names of their classes."""
        return {class_name(name): name for name in self._ids}

    @cached_property
    def enums_by_class(self) -> dict[str, str]:
        """Official names of the enums by the names of their classes; that of a message gets `Enum` added."""
        names = ((class_name(name), name) for name in self.enum_files)
        return {f"{made}Enum" if made in self.messages_by_class else made: name for made, name in names}


class EnumMapping(Mapping[str, EnumClass]):
    """The enums of a dialect by their official names."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect

    def __getitem__(self, name: str) -> EnumClass:
        return self._dialect.enum_class(name) if name in self else self._missing(name)

    def _missing(self, name: str) -> EnumClass:
        raise KeyError(name)

    def __contains__(self, name: object) -> bool:
        return name in self._dialect.enum_files

    def __iter__(self) -> Iterator[str]:
        return iter(self._dialect.enum_files)

    def __len__(self) -> int:
        return len(self._dialect.enum_files)


@cache
def _load(name: str) -> Dialect:
    table = load_table(name)
    return Dialect(table, [_load(include.removesuffix(".xml")) for include in table.includes])


def _from_source(source: Source) -> Dialect:
    """The dialect of a set of files; included files get dialects of their own."""
    from mavstack.dialects.includes import in_order

    made: dict[int, Dialect] = {}
    for item in in_order(source):
        includes = tuple(made[id(included)] for included in item.includes)
        made[id(item)] = (
            _load(item.definition.name) if item.official else _from_definition(item.definition, includes)
        )
    return made[id(source)]


@lru_cache(maxsize=64)
def _from_definition(definition: DialectDefinition, includes: tuple[Dialect, ...]) -> Dialect:
    """One dialect for one content of a file and of all that it includes."""
    from mavstack.dialects.codec import encode_table
    from mavstack.dialects.includes import with_settled_values

    highest: dict[str, int] = {}
    if any(entry.automatic for enum in definition.enums for entry in enum.entries):
        for item in includes:
            for name in item.enums:
                highest[name] = max(highest.get(name, 0), *item.enum_values(name).values(), 0)
    return Dialect(encode_table(with_settled_values(definition, highest)), includes, definition.path)
