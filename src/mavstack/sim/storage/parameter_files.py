"""The files of all parameters: ArduPilot's packed one, and PX4's, which holds what is not at its default.

ArduPilot's takes a query, "start=100&count=50&withdefaults=1", each part of which may be left out; what comes
by writing it are parameters to be set. PX4's is a BSON document: int32 (0x10) and double (0x01) by name.
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

_PART = re.compile(r"(start|count|withdefaults)=(\d{0,9})")
_MOST = 0xFFFF
_SIZE_EACH = 12


def packed_file(table: ParameterTable, set_all: Callable[[Sequence[Parameter]], None] | None) -> VirtualFile:
    """`@PARAM/param.pck` of a table."""

    def read(query: str) -> bytes:
        asked = {name: int(number or 0) for name, number in map(_part, query.split("&")) if name}
        start, count, defaults = (asked.get(name, 0) for name in ("start", "count", "withdefaults"))
        if start >= min(_MOST, len(table)) or count >= _MOST or defaults > 1:
            raise OSError(EINVAL, "there are no such parameters")
        return table.packed(start=start, count=count or None, with_defaults=defaults == 1)

    def write(content: bytes) -> None:
        found = packed.unpack(content)
        if found is None or set_all is None:
            raise OSError(EINVAL, "no parameters")
        set_all(found.parameters)

    return VirtualFile(
        read,
        None if set_all is None else write,
        size=lambda: len(table) * _SIZE_EACH,
        takes_query=True,
    )


def bson_file(table: ParameterTable) -> VirtualFile:
    """PX4's file of the parameters that are not at their default."""

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


def _part(text: str) -> tuple[str, str]:
    found = _PART.match(text)
    return (found[1], found[2]) if found else ("", "")
