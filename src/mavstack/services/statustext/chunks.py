"""A long text as STATUSTEXT chunks (guide: STATUSTEXT in the common messages).

A text of up to 50 bytes is one message with id 0. A longer one is cut into chunks of exactly 50 bytes that
have an id and are numbered from 0. A chunk that is not full has a NUL behind its text, and that says it is
the last: so after a text that fills its last chunk an empty one follows. UTF-8 may be cut in the middle of a
character, because a chunk that stops short would end the text.
"""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError

CHUNK = 50
#: Chunk numbers are one byte; the last chunk may be the empty one.
LONGEST = 255 * CHUNK
IDS = 1 << 16


def chunks_of(text: str, severity: int, number: int) -> list[common.Statustext]:
    """The messages of a text; `number` is the id that a long one gets, not 0."""
    data = text.replace("\0", " ").encode("utf-8", "replace")
    if len(data) <= CHUNK:
        return [common.Statustext(severity=severity, text=data)]
    if len(data) > LONGEST:
        raise LocalProtocolError(f"a status text of {len(data)} bytes is longer than {LONGEST}")
    parts = [data[start : start + CHUNK] for start in range(0, len(data) + 1, CHUNK)]
    return [
        common.Statustext(severity=severity, text=part, id=number, chunk_seq=index)
        for index, part in enumerate(parts)
    ]


def next_number(number: int) -> int:
    """The id of the text after the one with that id: 0 is left out."""
    return number % (IDS - 1) + 1
