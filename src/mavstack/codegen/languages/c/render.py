"""The files of a library in C99."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.language import GeneratedFile, Language
from mavstack.codegen.languages.c.dialects import dialect_parts
from mavstack.codegen.languages.c.messages import message_parts
from mavstack.codegen.languages.c.reserved import RESERVED, namespace
from mavstack.codegen.templates import Templates

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.library import Library

#: Files that do not depend on the dialect, apart from their first line.
RUNTIME: Final = (
    "CMakeLists.txt",
    "README.md",
    "checksum.h",
    "mavlink_conversions.h",
    "mavlink_framing.h",
    "mavlink_get_info.h",
    "mavlink_helpers.h",
    "mavlink_parser.h",
    "mavlink_sending.h",
    "mavlink_sha256.h",
    "mavlink_signing.h",
    "mavlink_types.h",
    "protocol.h",
)


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a library: the runtime, and a folder for each definition file."""
    templates = Templates("mavstack.codegen.languages.c", library=library)
    yield from runtime_files(templates, library)
    for file in library.files:
        parts = dialect_parts(library, file)
        yield templates.file(f"{file.name}/mavlink.h", "mavlink.h.j2", file=parts)
        yield templates.file(f"{file.name}/version.h", "version.h.j2", file=parts)
        yield templates.file(f"{file.name}/{file.name}.h", "dialect.h.j2", file=parts)
        yield templates.file(f"{file.name}/testsuite.h", "testsuite.h.j2", file=parts)
        for message in file.messages:
            values = message_parts(message, library.version)
            path = f"{file.name}/mavlink_msg_{message.name.lower()}.h"
            yield templates.file(path, "message.h.j2", m=message, v=values)


def runtime_files(templates: Templates, library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of the runtime, which the libraries in C and C++ share."""
    for path in RUNTIME:
        values = {"crc_tables": crc_tables(), "namespace": namespace(library.file_name)}
        yield templates.file(path, f"{path}.j2", **values)


@cache
def crc_tables() -> tuple[str, ...]:
    """Return four tables of 256 checksums: of a byte, and of a byte with one to three zeros behind it."""
    first = [_crc_of_byte(byte) for byte in range(256)]
    tables = [first]
    for _ in range(3):
        tables.append([crc >> 8 ^ first[crc & 0xFF] for crc in tables[-1]])
    return tuple(_table(table) for table in tables)


def _crc_of_byte(byte: int) -> int:
    mixed = (byte ^ byte << 4) & 0xFF
    return (mixed << 8 ^ mixed << 3 ^ mixed >> 4) & 0xFFFF


def _table(values: list[int]) -> str:
    rows = (values[start : start + 12] for start in range(0, len(values), 12))
    return ",\n".join("            " + ", ".join(f"0x{value:04X}" for value in row) for row in rows)


LANGUAGE: Final = Language("c", "C99", render, RESERVED)
