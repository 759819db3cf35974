"""A dialect: message and enum classes by name and id, created on first use.

A class belongs to the file that defines it, so `ardupilotmega.Attitude` is `common.Attitude`. If a dialect
adds entries to an enum (as ardupilotmega does to MAV_CMD), it has its own enum class, and each message with
such a field has a subclass whose field reads as the larger enum; a packet parsed with the larger dialect
still matches the class of the smaller one. The messages of a user's file are subclasses of the official ones
if they are equal on the wire, so that programs written for `common` work with any version of it.
"""

from __future__ import annotations

import os
from functools import cache, cached_property, lru_cache

from mavstack._core import Dialect as CoreDialect
from mavstack.dialects.classes import attribute_names, make_class, official_bases
from mavstack.dialects.enums import EnumClass, EnumMapping, make_enum, reserved_names
from mavstack.dialects.names import class_name, member_names
from mavstack.dialects.tables import MessageRow, Table, load_table, official_name, official_names
from mavstack.errors import UnknownMessageError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from os import PathLike
    from typing import Any

    from mavstack._core import FieldLayout, MessageLayout
    from mavstack.dialects.includes import DefinitionFile
    from mavstack.dialects.message import Message
    from mavstack.dialects.model import DialectDefinition, EnumDefinition, MessageDefinition

_INTEGERS_ONLY = ("float", "double", "char")


class Dialect:
    """The messages and enums of a definition file and of the files that it includes.

    `Dialect.load` and `Dialect.from_xml` create dialects. `dialect["ATTITUDE"]` and `dialect[30]` are message
    classes, `dialect.enums["MAV_CMD"]` is an enum class. Iterating yields all message classes.
    """

    def __init__(self, table: Table, includes: Iterable[Dialect], path: str = "") -> None:
        self.table = table
        self.includes = tuple(includes)
        self.path = path
        self._classes: dict[int, type[Message]] = {}
        self._enum_classes: dict[str, EnumClass] = {}
        self.definitions: dict[int, MessageDefinition] = {}
        self.enums = EnumMapping(self)

    @classmethod
    def load(cls, name: str) -> Dialect:
        """Load an official dialect.

        Args:
            name: The name, such as `common`, in upper or lower case.

        Returns:
            The dialect; the same object for each call.

        Raises:
            UnknownDialectError: There is no official dialect of that name.
        """
        return _load(official_name(name))

    @classmethod
    def from_xml(cls, path: str | bytes | PathLike[str]) -> Dialect:
        """Load a dialect from a MAVLink XML file, or from XML text, and the files that it includes.

        Args:
            path: Path of the file, or the XML itself as text or bytes. Includes are searched in the file's
                folder (of text: in the current one), then among the official definitions.

        Returns:
            The dialect; the same object again while the files are unchanged.

        Raises:
            DialectError: A file is missing, malformed or contradicts another; names the file and the line.
        """
        from mavstack.dialects.includes import collect, collect_text

        if isinstance(path, str | bytes):
            data = path.encode() if isinstance(path, str) else path
            if data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
                return _from_source(collect_text(data))
        return _from_source(collect(os.fsdecode(path)))

    @property
    def name(self) -> str:
        """Name of the definition file, without `.xml`."""
        return self.table.name

    @property
    def version(self) -> int | None:
        """The `<version>` of the file, or of the first included file that has one; None without any."""
        versions = (dialect.table.header["version"] for dialect in reversed(self.with_includes))
        return next((int(version) for version in versions if version is not None), None)

    @property
    def module_name(self) -> str:
        """The `__module__` of the classes: a dialect module, or the path of a user's file."""
        return self.path or f"mavstack.dialects.{self.name.lower()}"

    @cached_property
    def with_includes(self) -> tuple[Dialect, ...]:
        """This dialect and all that it includes, included ones first."""
        found = {id(item): item for dialect in self.includes for item in dialect.with_includes}
        return (*found.values(), self)

    @property
    def core_dialect(self) -> CoreDialect:
        """The layout tables of all messages, for the core."""
        # A property, since a `cached_property` does not match the protocol `HasCoreDialect` for pyright.
        return self._core_dialect

    @cached_property
    def _core_dialect(self) -> CoreDialect:
        # A generator: a list of the layouts of all messages would take a megabyte.
        layouts = (self.layout(row) for dialect in self.with_includes for row in dialect.table.rows())
        return CoreDialect(self.name, layouts, self.message_class)

    @property
    def dialect(self) -> Dialect:
        """The dialect itself, so that dialects and dialect modules have a common attribute."""
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all messages, such as `ATTITUDE`."""
        return tuple(self._ids)

    @cached_property
    def definition(self) -> DialectDefinition:
        """The definitions of all messages and enums, including those of included files."""
        from mavstack.dialects.merging import merge_definitions

        return merge_definitions([dialect.own_definition for dialect in self.with_includes])

    @cached_property
    def own_definition(self) -> DialectDefinition:
        """The definitions of this file alone."""
        from mavstack.dialects.codec import decode_table

        return decode_table(self.table)

    @cached_property
    def _ids(self) -> dict[str, int]:
        return {name: number for dialect in self.with_includes for name, number in dialect.table.ids.items()}

    @cached_property
    def _origins(self) -> dict[int, Dialect]:
        return {number: dialect for dialect in self.with_includes for number in dialect.table.ids.values()}

    def name_of(self, number: int) -> str:
        """Return the name of a message, without creating its class.

        Args:
            number: Id of the message.

        Returns:
            The name, such as `ATTITUDE`.

        Raises:
            KeyError: The dialect has no message of that id.
        """
        return str(self.row(number)[1])

    def row(self, number: int) -> MessageRow:
        """Return the row of a message in the table of the file that defines it."""
        return self._origins[number].table.row(number)

    def __getitem__(self, key: str | int) -> type[Message]:
        number = self._ids.get(key) if isinstance(key, str) else key
        if number is None or number not in self._origins:
            label = "" if isinstance(key, str) else "with id "
            raise UnknownMessageError(f"dialect {self.name} has no message {label}{key}")
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
        """Return the layout of a message for the core."""
        number, name, crc_extra, base_length, length, fields = row
        attributes = attribute_names(row) if self.path else [field[0] for field in fields]
        layouts: list[FieldLayout] = [
            (attributes[index], kind, count, offset, bool(enum) and kind not in _INTEGERS_ONLY)
            for index, (_, kind, count, offset, enum) in enumerate(fields)
        ]
        return number, name, crc_extra, base_length, length, layouts

    def message_class(self, number: int) -> type[Message]:
        """Return the class of a message, created on first use.

        Args:
            number: Id of a message of the dialect.

        Returns:
            The class.

        Raises:
            KeyError: The dialect has no message of that id.
        """
        created = self._classes.get(number)
        if created is None:
            owner = self._owner(number)
            created = owner.message_class(number) if owner is not self else self._make_class(number)
            created = self._classes.setdefault(number, created)
        return created

    def _owner(self, number: int) -> Dialect:
        """Return the first included dialect in which the message has the same enums as in this one."""
        enums = {field[4] for field in self.row(number)[5] if field[4]}
        origin = self._origins[number]
        owners = {enum: self.enum_owner(enum) for enum in enums}
        for dialect in self.with_includes:
            if origin in dialect.with_includes and all(
                dialect.enum_owner(enum) is owners[enum] for enum in enums
            ):
                return dialect
        return self

    def _make_class(self, number: int) -> type[Message]:
        row = self.row(number)
        parents = [dialect.message_class(number) for dialect in self.includes if number in dialect]
        if self.path:
            parents += official_bases(row, self._official_views())
        return make_class(self, row, parents, self._origins[number].table)

    def _official_views(self) -> list[Dialect]:
        """Return the official dialects that may define a user's message, that of the same name first."""
        names = [name for name in official_names() if name.lower() == self.name.lower()]
        return [Dialect.load(name) for name in dict.fromkeys([*names, "common"])]

    def message_definition(self, number: int) -> MessageDefinition:
        """Return the definition of a message.

        Args:
            number: Id of a message of the dialect.

        Returns:
            The definition, with descriptions, units and enums.

        Raises:
            KeyError: The dialect has no message of that id.
        """
        from mavstack.dialects.codec import decode_message

        origin = self._origins[number]
        if number not in origin.definitions:
            origin.definitions[number] = decode_message(self.row(number), origin.table)
        return origin.definitions[number]

    @cached_property
    def enum_files(self) -> dict[str, tuple[Dialect, ...]]:
        """The dialects that define entries of each enum."""
        files: dict[str, list[Dialect]] = {}
        for dialect in self.with_includes:
            for name in dialect.table.enum_names:
                files.setdefault(name, []).append(dialect)
        return {name: tuple(dialects) for name, dialects in files.items()}

    def enum_owner(self, name: str) -> Dialect:
        """Return the first included dialect with the same entries."""
        files = self.enum_files[name]
        if len(files) == 1:
            return files[0]
        return next(dialect for dialect in self.with_includes if dialect.enum_files.get(name) == files)

    def enum_class(self, name: str) -> EnumClass:
        """Return the class of an enum, created on first use.

        Args:
            name: Name of the enum, such as `MAV_CMD`.

        Returns:
            A subclass of `MavEnum`, or of `MavFlag` for a bitmask.

        Raises:
            KeyError: The dialect has no enum of that name.
        """
        created = self._enum_classes.get(name)
        if created is None:
            owner = self.enum_owner(name)
            created = owner.enum_class(name) if owner is not self else self._make_enum(name)
            created = self._enum_classes.setdefault(name, created)
        return created

    def _make_enum(self, name: str) -> EnumClass:
        entries, bitmask = self._enum_entries(name)
        bitmask = bitmask and all(value >= 0 for rows in entries for value, _, _ in rows)
        origin, *others = ([entry for _, entry, _ in rows] for rows in entries)
        added = [entry for names in others for entry in names if entry not in origin]
        python_names = member_names(name, origin, added, reserved_names(bitmask))
        members = {python_names[entry]: value for rows in entries for value, entry, _ in rows}
        python_name = class_name(name)
        if python_name in self.messages_by_class:
            python_name += "Enum"
        return make_enum(self, name, python_name, members, bitmask=bitmask)

    def _enum_entries(self, name: str) -> tuple[list[list[list[Any]]], bool]:
        """Return the entries [value, name, metadata] of an enum by file, and true if it is a bitmask."""
        rows = [dialect.table.enum_row(name) for dialect in self.enum_files[name]]
        return [entries for _, entries in rows], any(metadata.get("bitmask", False) for metadata, _ in rows)

    def enum_values(self, name: str) -> dict[str, int]:
        """Return the values of an enum.

        Args:
            name: Name of the enum, such as `MAV_CMD`.

        Returns:
            The values by entry name, such as `MAV_CMD_NAV_TAKEOFF`.

        Raises:
            KeyError: The dialect has no enum of that name.
        """
        return {entry: value for rows in self._enum_entries(name)[0] for value, entry, _ in rows}

    def enum_definition(self, name: str) -> EnumDefinition:
        """Return the definition of an enum, with the entries of all files.

        Args:
            name: Name of the enum, such as `MAV_CMD`.

        Returns:
            The definition.

        Raises:
            KeyError: The dialect has no enum of that name.
        """
        from mavstack.dialects.codec import decode_enum
        from mavstack.dialects.merging import merge_enum

        first, *others = (decode_enum(name, dialect.table) for dialect in self.enum_files[name])
        for more in others:
            first = merge_enum(first, more, self.path or self.name)
        return first

    @cached_property
    def messages_by_class(self) -> dict[str, str]:
        """Names of the messages by class name."""
        return {class_name(name): name for name in self._ids}

    @cached_property
    def enums_by_class(self) -> dict[str, str]:
        """Names of the enums by class name; `Enum` is appended to the name of a message class."""
        names = ((class_name(name), name) for name in self.enum_files)
        return {f"{cls}Enum" if cls in self.messages_by_class else cls: name for cls, name in names}


@cache
def _load(name: str) -> Dialect:
    table = load_table(name)
    return Dialect(table, [_load(include.removesuffix(".xml")) for include in table.includes])


def _from_source(source: DefinitionFile) -> Dialect:
    """Create the dialect of a definition file, and those of its included files."""
    from mavstack.dialects.includes import included_first

    dialects: dict[int, Dialect] = {}
    for item in included_first(source):
        includes = tuple(dialects[id(included)] for included in item.includes)
        name = item.definition.name
        dialects[id(item)] = _load(name) if item.official else _from_definition(item.definition, includes)
    return dialects[id(source)]


@lru_cache(maxsize=64)
def _from_definition(definition: DialectDefinition, includes: tuple[Dialect, ...]) -> Dialect:
    """Create a dialect; equal definitions and includes give the same object."""
    from mavstack.dialects.codec import encode_table
    from mavstack.dialects.includes import with_automatic_values

    highest: dict[str, int] = {}
    if any(entry.automatic for enum in definition.enums for entry in enum.entries):
        for dialect, name in [(included, name) for included in includes for name in included.enums]:
            highest[name] = max(highest.get(name, 0), *dialect.enum_values(name).values(), 0)
    definition = with_automatic_values(definition, highest)
    dialect = Dialect(encode_table(definition), includes, definition.path)
    dialect.own_definition = definition  # keep the definition, so that the table need not be decoded
    return dialect
