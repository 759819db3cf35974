"""Parameter files over FTP: ArduPilot's packed file, and PX4's BSON file of changed parameters.

ArduPilot's file accepts a query, "start=100&count=50&withdefaults=1", with every option optional; writing the
file sets parameters. PX4's file is a BSON document: int32 (0x10) and double (0x01) by name.
"""

from __future__ import annotations

import re
from errno import EINVAL
from struct import pack
from typing import TYPE_CHECKING

from mavstack.services.ftp import VirtualFile
from mavstack.services.parameters import packed

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.services.parameters import Parameter, ParameterTable

_OPTION = re.compile(r"(start|count|withdefaults)=(\d{0,9})")
_MAX_COUNT = 0xFFFF
_BYTES_PER_PARAMETER = 12


def packed_file(table: ParameterTable, set_all: Callable[[Sequence[Parameter]], None] | None) -> VirtualFile:
    """Return `@PARAM/param.pck` of a table; it is read-only if `set_all` is None."""

    def read(query: str) -> bytes:
        options = {name: int(number or 0) for name, number in map(_query_option, query.split("&")) if name}
        start, count, defaults = (options.get(name, 0) for name in ("start", "count", "withdefaults"))
        if start >= min(_MAX_COUNT, len(table)) or count >= _MAX_COUNT or defaults > 1:
            raise OSError(EINVAL, "no such parameters")
        return table.packed(start=start, count=count or None, with_defaults=defaults == 1)

    def write(content: bytes) -> None:
        found = packed.unpack(content)
        if found is None or set_all is None:
            raise OSError(EINVAL, "no parameters")
        set_all(found.parameters)

    return VirtualFile(
        read,
        None if set_all is None else write,
        size=lambda: len(table) * _BYTES_PER_PARAMETER,
        takes_query=True,
    )


def bson_file(table: ParameterTable) -> VirtualFile:
    """Return PX4's file of the parameters that differ from their defaults."""

    def read(query: str) -> bytes:
        content = bytearray()
        for definition in table:
            value, name = definition.value, definition.name.encode() + b"\0"
            if value == definition.default:
                continue
            if isinstance(value, int):
                content += b"\x10" + name + pack("<I", value & 0xFFFFFFFF)
            else:
                content += b"\x01" + name + pack("<d", value)
        return pack("<i", len(content) + 5) + content + b"\0"

    return VirtualFile(read)


def _query_option(text: str) -> tuple[str, str]:
    """Return name and number of a query option; empty if it is none."""
    found = _OPTION.match(text)
    return (found[1], found[2]) if found else ("", "")
