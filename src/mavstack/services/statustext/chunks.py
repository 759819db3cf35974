"""The chunks of a long STATUSTEXT (guide: STATUSTEXT in the common messages).

A text of up to 50 bytes is one message with id 0. A longer one is split into chunks of exactly 50 bytes that
share an id and are numbered from 0. A chunk with a NUL behind its text is the last one: so a text that fills
its last chunk is followed by an empty chunk. UTF-8 may be split in the middle of a character, because a
shorter chunk would end the text.
"""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

CHUNK = 50
#: The longest text in bytes: the number of a chunk is one byte, and the last chunk may be empty.
MAX_LENGTH = 255 * CHUNK
IDS = 1 << 16


def chunks_of(text: str, severity: int, number: int) -> list[common.Statustext]:
    """Return the messages of a text; `number` is the id of a long one, not 0."""
    data = text.replace("\0", " ").encode("utf-8", "replace")
    if len(data) <= CHUNK:
        return [common.Statustext(severity=severity, text=data)]
    if len(data) > MAX_LENGTH:
        raise InvalidArgumentError(f"a status text must have at most {MAX_LENGTH} bytes, got {len(data)}")
    parts = [data[start : start + CHUNK] for start in range(0, len(data) + 1, CHUNK)]
    return [
        common.Statustext(severity=severity, text=part, id=number, chunk_seq=index)
        for index, part in enumerate(parts)
    ]


def next_number(number: int) -> int:
    """Return the id that follows an id: 0 is skipped."""
    return number % (IDS - 1) + 1
