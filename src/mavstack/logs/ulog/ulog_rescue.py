"""Rescue of ULog files: the messages that the index accepts and whose content makes sense, byte for byte.

The index of a large part of the file shows whether there is damage in it. Such a part is indexed again in
smaller and smaller parts, so that only the messages beside the damage are examined one by one.

Appended data (the report of a crash) follows the other messages directly in the new file, so the offsets in
the flag bits are cleared.
"""

from __future__ import annotations

from struct import error
from typing import TYPE_CHECKING, Final

from mavstack._core import UlogIndex
from mavstack.errors import LogError
from mavstack.logs.rescue import Rescue
from mavstack.logs.ulog.entries import parse_value
from mavstack.logs.ulog.ulog import ULog

if TYPE_CHECKING:
    import mmap
    from collections.abc import Callable, Generator, Iterator

    from mavstack.logs.log_bytes import LogBytes

    Ranges = Generator[tuple[int, int], None, UlogIndex]

_STEPS: Final = (1 << 20, 1 << 14, 1 << 8, 1)
_HEADER: Final = 16
_MESSAGE_HEADER: Final = 3
#: Positions of the incompatible flags and of the offsets of appended data in a file.
_FLAGS: Final = slice(27, 28)
_OFFSETS: Final = slice(35, 59)
_DATA_APPENDED: Final = 1
#: Bytes before the text, by kind of logged text.
_TEXTS: Final = {"L": 9, "C": 11}
_DROPOUT: Final = 2


class UlogRescue(Rescue):
    """Finds the messages of a ULog."""

    def __init__(self, data: LogBytes) -> None:
        super().__init__(data)
        self._log = ULog(data)

    def pieces(self, progress: Callable[[int, int], None]) -> Iterator[bytes]:
        """Yield the messages; see `Rescue.pieces`."""
        with self.data.access() as data:
            try:
                index: UlogIndex | None = UlogIndex(data, size=0)
            except ValueError as problem:
                raise LogError(f"cannot repair {self.data.path}: {problem}") from None
            yield bytes(data[:_HEADER])
            while index is not None:
                start, found = index.end, index
                index = yield from self._piece(data, found)
                progress(start if index is None else index.end, self.data.size)
        self.damage = self._log.skipped

    def _piece(self, data: mmap.mmap | bytes, before: UlogIndex) -> Generator[bytes, None, UlogIndex | None]:
        """Yield the messages after an index, and return the index of them."""
        if before.end >= self.data.size:
            return None
        ranges = _sound_ranges(before, 0)
        while True:
            try:
                start, end = next(ranges)
            except StopIteration as stop:
                after: UlogIndex = stop.value
                return after
            content = bytes(data[start:end])
            self.records += _count(content)
            yield _without_appended_data(content) if start == _HEADER else content


def _sound_ranges(before: UlogIndex, level: int) -> Ranges:
    """Yield the ranges of sound messages in the next part of a file, and return the index of that part."""
    piece = before.following(_STEPS[level])
    if piece is None:
        return before
    skipped = dict(piece.damage)
    junk = skipped["bad_bytes"] + skipped["truncated_bytes"]
    if _is_sound(piece):
        # A sound piece with junk consists of the junk and one message after it.
        if not junk:
            yield before.end, piece.end
            return piece
        if level == len(_STEPS) - 1:
            if before.end + junk < piece.end:
                yield before.end + junk, piece.end
            return piece
    elif level == len(_STEPS) - 1:
        return piece
    current = before
    while current.end < piece.end:
        current = yield from _sound_ranges(current, level + 1)
    return current


def _is_sound(piece: UlogIndex) -> bool:
    """Return whether every message of a part can be used; there may be junk before or between them."""
    skipped = dict(piece.damage)
    unusable = skipped["wrong_size"] or skipped["bad_definitions"]
    return not (unusable or piece.unsubscribed or piece.unknown_kinds) and all(
        _makes_sense(kind, body) for kind in "IMPQLCO" for _, _, body in piece.messages(kind)
    )


def _makes_sense(kind: str, body: bytes) -> bool:
    """Return whether the content of a message that is no record can be read."""
    if kind in _TEXTS:
        return len(body) >= _TEXTS[kind] and _is_text(body[_TEXTS[kind] :])
    if kind == "O":
        return len(body) == _DROPOUT
    value = body[1:] if kind in "MQ" else body
    try:
        _, parsed = parse_value(value)
    except (ValueError, error):
        return False
    if kind in "PQ":
        return isinstance(parsed, int | float)
    return not isinstance(parsed, str) or _is_text(value[1 + value[0] :])


def _is_text(text: bytes) -> bool:
    try:
        text.decode()
    except UnicodeDecodeError:
        return False
    return True


def _count(messages: bytes) -> int:
    """Return the number of messages that follow each other."""
    count = position = 0
    while position + _MESSAGE_HEADER <= len(messages):
        position += _MESSAGE_HEADER + int.from_bytes(messages[position : position + 2], "little")
        count += 1
    return count


def _without_appended_data(messages: bytes) -> bytes:
    """Return the beginning of a file, in which no data is marked as appended."""
    if messages[2:3] != b"B" or len(messages) < _OFFSETS.stop - _HEADER:
        return messages
    changed = bytearray(messages)
    changed[_FLAGS.start - _HEADER] &= ~_DATA_APPENDED & 0xFF
    changed[_OFFSETS.start - _HEADER : _OFFSETS.stop - _HEADER] = bytes(_OFFSETS.stop - _OFFSETS.start)
    return bytes(changed)
