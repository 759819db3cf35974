"""The parts of a dialect's header: tables of its messages, and the enums with all their entries.

Each definition file has a folder of its own, whose headers work without the files that include it. An enum
that several files extend is complete in the folder of each file that adds entries, or that joins such files;
the first definition that the compiler reads counts, which is that of the including file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple
from zlib import crc32

from mavstack.codegen.languages.c.reserved import identifier, namespace
from mavstack.codegen.templates import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.codegen.library import DialectFile, Library
    from mavstack.dialects.model import EnumDefinition, EnumEntry, MessageDefinition

_INT_MAX: Final = 2**31 - 1
_TARGETS: Final = ("target_system", "target_component")


class DialectParts(NamedTuple):
    """Texts of a dialect for the templates of its headers."""

    name: str
    macro: str
    hash: int
    version: int
    includes: tuple[str, ...]
    message_files: tuple[str, ...]
    max_payload_length: int
    entries: str
    own_entries: str
    test_name: str
    test_names: tuple[str, ...]
    infos: str
    names: str
    enums: str


def dialect_parts(library: Library, file: DialectFile) -> DialectParts:
    """Return the texts of the folder of a definition file."""
    files = closure(library, file)
    messages = sorted((message for item in files for message in item.messages), key=lambda item: item.id)
    return DialectParts(
        name=file.name,
        macro=namespace(file.name).upper(),
        hash=crc32(file.name.encode()),
        version=library.version,
        includes=file.includes,
        message_files=tuple(message.name.lower() for message in file.messages),
        max_payload_length=max((message.length for message in messages), default=0),
        entries=_entry_rows(messages),
        own_entries=_entry_rows(file.messages),
        test_name=_test_name(file),
        test_names=tuple(map(_test_name, files)),
        infos=", \\\n".join(f"    MAVLINK_MESSAGE_INFO_{message.name}" for message in messages)
        or '    {0xFFFFFFFF, "", 0, {{NULL, NULL, MAVLINK_TYPE_CHAR, 0, 0, 0, NULL, NULL}}}',
        names=", \\\n".join(
            f'    {{"{message.name}", {message.id}}}'
            for message in sorted(messages, key=lambda item: item.name)
        )
        or '    {"", 0xFFFFFFFF}',
        enums="\n".join(_enum(enum, entries) for enum, entries in enums(library, file)),
    )


def _entry_rows(messages: Iterable[MessageDefinition]) -> str:
    """Return the rows of a table of messages; a row with an impossible id if there is none."""
    rows = ", \\\n".join(f"    {entry(message)}" for message in messages)
    return rows or "    {0xFFFFFFFF, 0, 0, 0, 0, 0, 0}"


def _test_name(file: DialectFile) -> str:
    """Return the end of the name of the function that tests a file; `mavlink_test_all` is taken."""
    return "all_" if file.name == "all" else namespace(file.name)


def closure(library: Library, file: DialectFile) -> tuple[DialectFile, ...]:
    """Return a file and all files that it includes, in the order of the library."""
    files = {item.name: item for item in library.files}
    names, pending = set[str](), [file.name]
    while pending:
        name = pending.pop()
        if name not in names and name in files:
            names.add(name)
            pending += files[name].includes
    return tuple(item for item in library.files if item.name in names)


def enums(library: Library, file: DialectFile) -> Iterator[tuple[EnumDefinition, tuple[EnumEntry, ...]]]:
    """Yield the enums that a file defines, extends or joins, each with its entries in the file's closure."""
    below = [_entries(closure(library, item)) for item in library.files if item.name in file.includes]
    for name, (enum, entries) in _entries(closure(library, file)).items():
        if all(len(entries) > len(other[name][1]) for other in below if name in other):
            yield enum, tuple(sorted(entries.values(), key=lambda item: item.value))


def _entries(files: tuple[DialectFile, ...]) -> dict[str, tuple[EnumDefinition, dict[str, EnumEntry]]]:
    found: dict[str, tuple[EnumDefinition, dict[str, EnumEntry]]] = {}
    for file in files:
        for enum in file.enums:
            found.setdefault(enum.name, (enum, {}))[1].update((item.name, item) for item in enum.entries)
    return found


def entry(message: MessageDefinition) -> str:
    """Return the initialiser of a message's `mavlink_msg_entry_t`."""
    targets = [message.by_name.get(name) for name in _TARGETS]
    flags = sum(bit for bit, field in zip((1, 2), targets, strict=True) if field)
    offsets = ", ".join(str(field.offset if field else 0) for field in targets)
    return (
        f"{{{message.id}, {message.crc_extra}, {message.base_length}, {message.length}, {flags}, {offsets}}}"
    )


def _enum(enum: EnumDefinition, entries: tuple[EnumEntry, ...]) -> str:
    """Return an enum: values that do not fit into an `int`, the type of enumerators in C99, are macros."""
    end = enum_end(entries)
    values = [(identifier(item.name), item.value, one_line(item.description)) for item in entries]
    values.append((f"{enum.name}_ENUM_END", end, ""))
    lines = "\n".join(
        f"    {name} = {value},{_note(note)}"
        for name, value, note in values
        if -_INT_MAX <= value <= _INT_MAX
    )
    macros = "".join(
        f"#define {name} {_macro_value(value)}{_note(note)}\n"
        for name, value, note in values
        if not -_INT_MAX <= value <= _INT_MAX
    )
    name = identifier(enum.name)
    name += "_" * any(name == entry for entry, _, _ in values)
    comment, guard = _note(one_line(enum.description)).strip(), f"HAVE_ENUM_{enum.name}"
    return (
        f"{comment}\n#ifndef {guard}\n#define {guard}\n"
        f"typedef enum {name} {{\n{lines.removesuffix(',')}\n}} {name};\n{macros}#endif\n"
    ).lstrip("\n")


def enum_end(entries: Iterable[EnumEntry]) -> int:
    """Return the value of an enum's `_ENUM_END`: one more than the greatest value, if 64 bits hold it."""
    return min(max((item.value for item in entries), default=-1) + 1, 2**64 - 1)


def _macro_value(value: int) -> str:
    """Return a number that is no `int`; the most negative one is not a constant of C."""
    if value < 0:
        return f"({value + 1}LL - 1)"
    return f"{value}ULL" if value > 2**32 - 1 else f"{value}U"


def _note(text: str) -> str:
    return f" /* {text} */" if text else ""
