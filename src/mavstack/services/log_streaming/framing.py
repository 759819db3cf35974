"""The framing of ULog as far as a stream needs it: the header, and the length of each message."""

from __future__ import annotations

from struct import Struct
from typing import Final

MAGIC: Final = b"ULog\x01\x12\x35"
#: The size of the file header in bytes: magic, version, time.
HEADER_SIZE: Final = 16
#: The number of log bytes in one message.
BLOCK_SIZE: Final = 249
#: The offset that means that no log message starts in the block.
NO_START: Final = 255
#: The number of sequence numbers of blocks, after which they wrap to 0.
SEQUENCES: Final = 1 << 16
#: A sequence number that is further ahead of the expected one belongs to an older block.
HALF: Final = SEQUENCES // 2

_MESSAGE: Final = Struct("<HB")
_DROPOUT: Final = Struct("<HBH")
_MAX_DROPOUT: Final = 0xFFFF


def whole_messages(data: bytes | bytearray, start: int = 0) -> int:
    """Return the end of the last complete message in `data`, the first of which begins at `start`."""
    end = start
    while end + _MESSAGE.size <= len(data):
        size = _MESSAGE.size + _MESSAGE.unpack_from(data, end)[0]
        if end + size > len(data):
            break
        end += size
    return end


def message_starts(data: bytes | bytearray, start: int = 0) -> list[int]:
    """Return where the messages in `data` begin, the first of which begins at `start`."""
    starts = []
    while start < len(data):
        starts.append(start)
        if start + _MESSAGE.size > len(data):
            break
        start += _MESSAGE.size + _MESSAGE.unpack_from(data, start)[0]
    return starts


def dropout(seconds: float) -> bytes:
    """Return the message of a gap in the log, whose length it has in milliseconds."""
    milliseconds = min(max(round(seconds * 1000), 1), _MAX_DROPOUT)
    return _DROPOUT.pack(2, ord("O"), milliseconds)
