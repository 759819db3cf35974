"""The registration of ULog, which is recognised by its first bytes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.logs.registry import LogFormat

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.logs.options import OpenOptions

_MAGIC: Final = b"ULog\x01\x12\x35"


def _open(data: LogBytes, options: OpenOptions) -> Log:
    from mavstack.logs.ulog.ulog import ULog

    return ULog(data, threads=options.threads)


def _has_signature(head: bytes) -> bool:
    return head.startswith(_MAGIC)


ULOG: Final = LogFormat("ulog", "PX4's onboard log (.ulg)", _has_signature, _open)
