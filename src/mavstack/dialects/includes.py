"""A definition file with all included files: searched, ordered and checked against each other.

An included file is searched in the folder of the including file, then among the official definitions, so that
a custom dialect needs no copies of them. Files are ordered with included ones first, each once; an include
cycle is an error. Enums of the same name are merged; a message id, a message name, an entry name and an entry
value must be unique.

A field may use an enum of a file that its own file does not include, if another file includes both: mavgen
reads all files as one. The classes of a file are created without the files that include it, so `collect`
moves such an enum, with all its entries, to the file of the field.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects.codec import decode_table
from mavstack.dialects.merging import merge_enums, renumbered
from mavstack.dialects.tables import load_table, official_names
from mavstack.dialects.xml_definitions import parse_definition
from mavstack.dialects.xml_reader import read_bytes
from mavstack.errors import DialectError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack.dialects.model import DialectDefinition, EnumDefinition, MessageDefinition

#: The path in error texts of a definition that was given as text.
TEXT_NAME = "<text>"
MAX_FILES = 100
MAX_INCLUDE_DEPTH = 20


class DefinitionFile(NamedTuple):
    """A definition file with the files that it includes directly; `official` if it is a built-in dialect."""

    definition: DialectDefinition
    includes: tuple[DefinitionFile, ...]
    official: bool


@lru_cache(maxsize=64)
def official_definition(name: str) -> DialectDefinition:
    """Return the definition in an official file, without its includes."""
    return decode_table(load_table(name))


class _Collector:
    """Reads included files depth first; `chain` is the path of includes to the current file."""

    def __init__(self) -> None:
        self.done: dict[str, DefinitionFile] = {}
        self.chain: list[str] = []

    def text(self, data: bytes) -> DefinitionFile:
        return self._source(TEXT_NAME, TEXT_NAME, data)

    def file(self, path: str) -> DefinitionFile:
        return self._source(str(Path(path).resolve()), path, None)

    def _source(self, key: str, path: str, data: bytes | None) -> DefinitionFile:
        if key not in self.done:
            definition = parse_definition(read_bytes(path) if data is None else data, path, file_stem(path))
            self.chain.append(key)
            lines = definition.include_lines
            sources = tuple(map(self.include, [definition] * len(lines), definition.includes, lines))
            self.chain.pop()
            self.done[key] = DefinitionFile(definition, sources, official=False)
        return self.done[key]

    def include(self, definition: DialectDefinition, name: str, line: int) -> DefinitionFile:
        path = str(Path(definition.path).parent / name)
        if not Path(path).is_file():
            if file_stem(name) in official_names():
                return self.official(file_stem(name))
            raise DialectError(f"includes {name}, which does not exist", definition.path, line)
        key = str(Path(path).resolve())
        if key in self.chain:
            names = [Path(item).name for item in (*self.chain[self.chain.index(key) :], key)]
            raise DialectError(f"include cycle: {' -> '.join(names)}", definition.path, line)
        if len(self.chain) >= MAX_INCLUDE_DEPTH:
            raise DialectError(f"includes are nested deeper than {MAX_INCLUDE_DEPTH}", definition.path, line)
        if len(self.done) + len(self.chain) >= MAX_FILES:
            raise DialectError(f"more than {MAX_FILES} files are included", definition.path, line)
        return self.file(path)

    def official(self, name: str) -> DefinitionFile:
        if name not in self.done:
            definition = official_definition(name)
            sources = tuple(self.official(file_stem(item)) for item in definition.includes)
            self.done[name] = DefinitionFile(definition, sources, official=True)
        return self.done[name]


def file_stem(path: str) -> str:
    """Return the dialect name of a path: `common` for `folder/common.xml`."""
    name = Path(path).name
    return name[:-4] if name.lower().endswith(".xml") else name


def collect(path: str) -> DefinitionFile:
    """Read a definition file and all included files, and check them.

    Args:
        path: Path of the XML file.

    Returns:
        The file with its includes; each has the enums that its fields use.

    Raises:
        DialectError: A file is missing, malformed or contradicts another.
    """
    return _with_used_enums(collect_as_written(path))


def collect_as_written(path: str) -> DefinitionFile:
    """Read and check the files as `collect` does, and leave each enum in its file."""
    source = _Collector().file(path)
    check_definitions([item.definition for item in included_first(source)])
    return source


def collect_text(data: bytes) -> DefinitionFile:
    """Read a definition from XML text, and all included files, and check them; see `collect`."""
    source = _Collector().text(data)
    check_definitions([item.definition for item in included_first(source)])
    return _with_used_enums(source)


def included_first(source: DefinitionFile) -> list[DefinitionFile]:
    """Return a file and all included files, included ones first, each once."""
    found: dict[int, DefinitionFile] = {}

    def visit(item: DefinitionFile) -> None:
        for child in item.includes:
            if id(child) not in found:
                visit(child)
        found.setdefault(id(item), item)

    visit(source)
    return list(found.values())


def check_definitions(definitions: Iterable[DialectDefinition]) -> None:
    """Raise `DialectError` if files contradict each other, or a field refers to an undefined enum."""
    definitions = tuple(definitions)
    _check_messages(definitions)
    enums = merge_enums(definitions)
    for definition in definitions:
        for message in definition.messages:
            for item in message.fields:
                if item.enum and item.enum not in enums:
                    problem = f"{message.name}.{item.name} refers to the undefined enum {item.enum}"
                    raise DialectError(problem, definition.path or definition.name, item.line or None)


class EnumUse(NamedTuple):
    """A field whose enum is defined in a file that the file of the field does not include."""

    field: str
    enum: str
    path: str
    line: int


def foreign_enums(source: DefinitionFile) -> list[EnumUse]:
    """Return the uses of enums of files that are not included, in a file that `collect_as_written` read."""
    return [
        EnumUse(f"{message.name}.{field.name}", field.enum, item.definition.path, field.line)
        for item in included_first(source)
        if not item.official
        for known in [{enum.name for each in included_first(item) for enum in each.definition.enums}]
        for message in item.definition.messages
        for field in message.fields
        if field.enum and field.enum not in known
    ]


def _with_used_enums(source: DefinitionFile) -> DefinitionFile:
    """Return the files; the first that use or define an enum of `foreign_enums` have all its entries."""
    names = {use.enum for use in foreign_enums(source)}
    if not names:
        return source
    files = included_first(source)
    merged = merge_enums([item.definition for item in files])
    enums = {name: _numbered(merged[name]) for name in sorted(names)}
    done: dict[int, DefinitionFile] = {}
    complete: dict[int, frozenset[str]] = {}
    for item in files:
        includes = tuple(done[id(each)] for each in item.includes)
        known = frozenset().union(*(complete[id(each)] for each in item.includes))
        definition = item.definition
        if not item.official:
            added = [name for name in enums if name not in known and name in _enum_names(definition)]
            kept = [enum for enum in definition.enums if enum.name not in enums]
            definition = definition._replace(enums=(*kept, *(enums[name] for name in added)))
            known |= frozenset(added)
        done[id(item)], complete[id(item)] = DefinitionFile(definition, includes, item.official), known
    return done[id(source)]


def _enum_names(definition: DialectDefinition) -> set[str]:
    """Return the enums that a file defines, and those that its fields use."""
    used = {field.enum for message in definition.messages for field in message.fields}
    return used | {enum.name for enum in definition.enums}


def _numbered(enum: EnumDefinition) -> EnumDefinition:
    """Return an enum whose entries keep their values in another file."""
    return enum._replace(entries=tuple(entry._replace(automatic=False) for entry in enum.entries))


def _check_messages(definitions: Iterable[DialectDefinition]) -> None:
    ids: dict[int, tuple[MessageDefinition, DialectDefinition]] = {}
    names: dict[str, tuple[MessageDefinition, DialectDefinition]] = {}
    for definition in definitions:
        for message in definition.messages:
            location = definition.path or definition.name, message.line or None
            other, file = ids.setdefault(message.id, (message, definition))
            if file is not definition:
                raise DialectError(
                    f"message id {message.id} is already used by {other.name} of {file.name}", *location
                )
            _, file = names.setdefault(message.name, (message, definition))
            if file is not definition:
                raise DialectError(f"message {message.name} is already defined in {file.name}", *location)


def with_automatic_values(definition: DialectDefinition, highest: Mapping[str, int]) -> DialectDefinition:
    """Return a definition whose entries without a value follow the highest values of the included files."""
    enums = tuple(renumbered(enum, highest.get(enum.name, 0)) for enum in definition.enums)
    return definition._replace(enums=enums)
