"""The registration of Blackbox logs, which are recognised by their first header line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.logs.registry import LogFormat

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.logs.options import OpenOptions

_MARKER: Final = b"H Product:Blackbox flight data recorder"
#: A file that was read from a flash chip may begin in the middle of a flight.
_SEARCHED: Final = 1 << 14


def _open(data: LogBytes, _options: OpenOptions) -> Log:
    from mavstack.logs.blackbox.blackbox_log import BlackboxLog

    return BlackboxLog(data)


def _has_marker(head: bytes) -> bool:
    return _MARKER in head[:_SEARCHED]


BLACKBOX: Final = LogFormat("blackbox", "Betaflight Blackbox log (.bbl)", _has_marker, _open)
