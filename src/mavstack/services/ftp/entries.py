"""Directory entries, and their encoding: `Fname TAB size NUL`, `Dname NUL`, `S NUL`.

A listing addresses entries by index, so an entry that cannot be encoded (a tab in its name, too long, neither
file nor directory) is sent as a skip and counts. A reader ignores entries that it does not understand, but
counts them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.services.ftp.payload import MAX_DATA

if TYPE_CHECKING:
    from collections.abc import Sequence

SKIP = b"S\0"


@dataclass(frozen=True, slots=True)
class Entry:
    """A file or a directory.

    Attributes:
        name: The name, without the path.
        is_directory: True for a directory.
        size: The size in bytes; 0 for a directory.
        modified: The time of the last change, Unix seconds; 0 if unknown.
    """

    name: str
    is_directory: bool = False
    size: int = 0
    modified: int = 0

    def to_bytes(self, *, with_time: bool = False) -> bytes:
        """Encode the entry."""
        name = self.name.encode("utf-8", "surrogateescape")
        if not name or b"\t" in name or b"\0" in name:
            return SKIP
        text = b"D" + name if self.is_directory else b"F%s\t%d" % (name, self.size)
        if with_time:
            text += b"\t%d" % self.modified if not self.is_directory else b"\t0\t%d" % self.modified
        return text + b"\0" if len(text) < MAX_DATA else SKIP


def pack_entries(entries: Sequence[Entry], first: int, *, with_time: bool = False) -> bytes:
    """Encode as many entries from index `first` on as fit into one payload."""
    page = b""
    for entry in entries[first:]:
        text = entry.to_bytes(with_time=with_time)
        if len(page) + len(text) > MAX_DATA:
            break
        page += text
    return page


def read_entries(page: bytes) -> tuple[list[Entry], int]:
    """Decode the entries of a page; returns them and the number of indices that the page covers."""
    texts = page.removesuffix(b"\0").split(b"\0") if page else []
    found = [entry for entry in map(_read_entry, texts) if entry is not None]
    return found, len(texts)


def _read_entry(text: bytes) -> Entry | None:
    name, *numbers = text[1:].decode("utf-8", "surrogateescape").split("\t")
    if text[:1] not in (b"F", b"D") or not name:
        return None
    size, modified, *_ = (*map(_whole, numbers), 0, 0)
    is_directory = text[:1] == b"D"
    return Entry(name, is_directory, 0 if is_directory else size, modified)


def _whole(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 20 else 0
