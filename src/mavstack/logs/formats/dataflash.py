"""Recognition of DataFlash logs by their content."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from mavstack.logs.registry import LogFormat

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.logs.options import OpenOptions

_FMT_HEADER: Final = b"\xa3\x95\x80"
#: Length of an FMT record.
_FMT_LENGTH: Final = 89
_FMT_NAME: Final = b"FMT"
_FMT_LINE: Final = re.compile(rb"(?:\A|\n)FMT, ?128, ?89, ?FMT,")
#: Text logs of old firmware have some lines before the first FMT.
_TEXT_HEAD: Final = 8192


def is_binary(head: bytes) -> bool:
    """Return whether a file is a binary log.

    Args:
        head: The beginning of the file.
    """
    return head.startswith(_FMT_HEADER) or _has_fmt_records(head)


def _has_fmt_records(head: bytes) -> bool:
    """Return whether three FMT records follow each other, as in a log whose beginning is damaged.

    A tlog of a log download holds FMT records too, but in packets.
    """
    place = head.find(_FMT_HEADER)
    while place >= 0:
        following = (place + _FMT_LENGTH, place + 2 * _FMT_LENGTH)
        if all(head.startswith(_FMT_HEADER, start) for start in following) and (
            place + 3 * _FMT_LENGTH <= len(head)
        ):
            return True
        place = head.find(_FMT_HEADER, place + 1)
    return False


def is_text(head: bytes) -> bool:
    """Return whether a file is a log as text.

    Args:
        head: The beginning of the file.
    """
    beginning = head[:_TEXT_HEAD]
    return _FMT_NAME in beginning and _FMT_LINE.search(beginning) is not None


def _open_binary(data: LogBytes, options: OpenOptions) -> Log:
    from mavstack.logs.dataflash.dataflash_log import DataFlashLog

    return DataFlashLog(data, threads=options.threads)


def _open_text(data: LogBytes, _options: OpenOptions) -> Log:
    from mavstack.logs.dataflash.text_log import DataFlashTextLog

    return DataFlashTextLog(data)


DATAFLASH: Final = LogFormat("dataflash", "ArduPilot DataFlash log (.BIN)", is_binary, _open_binary)
DATAFLASH_TEXT: Final = LogFormat(
    "dataflash-text", "ArduPilot DataFlash log as text (.log)", is_text, _open_text
)
