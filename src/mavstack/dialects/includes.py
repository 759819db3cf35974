"""A definition file with all included files: searched, ordered and checked against each other.

An included file is searched in the folder of the including file, then among the official definitions, so that
a custom dialect needs no copies of them. Files are ordered with included ones first, each once; an include
cycle is an error. Enums of the same name are merged; a message id, a message name, an entry name and an entry
value must be unique.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects.codec import decode_table
from mavstack.dialects.merging import merge_definitions, merge_enums, renumbered
from mavstack.dialects.tables import load_table, official_names
from mavstack.dialects.xml_definitions import parse_definition
from mavstack.dialects.xml_reader import read_bytes
from mavstack.errors import DialectError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack.dialects.model import DialectDefinition, MessageDefinition

#: The path, in errors, of a definition that was given as text.
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
        The file with its includes.

    Raises:
        DialectError: A file is missing, malformed or contradicts another.
    """
    source = _Collector().file(path)
    sources = included_first(source)
    check_definitions([item.definition for item in sources])
    for item in sources:
        if not item.official:
            _check_enums(item)
    return source


def collect_text(data: bytes) -> DefinitionFile:
    """Read a definition from XML text, and all included files, and check them; see `collect`."""
    source = _Collector().text(data)
    check_definitions([item.definition for item in included_first(source)])
    return source


def collect_official(name: str) -> DefinitionFile:
    """Return an official definition with its includes."""
    return _Collector().official(name)


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


def _check_enums(source: DefinitionFile) -> None:
    """Raise `DialectError` if a field refers to an enum that neither its file nor an included one defines.

    The classes of a file are created without the files that include it.
    """
    known = {enum.name for item in included_first(source) for enum in item.definition.enums}
    for message in source.definition.messages:
        for item in message.fields:
            if item.enum and item.enum not in known:
                field = f"{message.name}.{item.name}"
                problem = f"{field} refers to the enum {item.enum} of a file that is not included here"
                raise DialectError(problem, source.definition.path, item.line or None)


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


def merged_definition(source: DefinitionFile) -> DialectDefinition:
    """Return one definition with the messages and enums of a file and its includes."""
    return merge_definitions([item.definition for item in included_first(source)])
