"""The registration of captures, which are recognised by their first bytes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.logs.registry import LogFormat

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.logs.options import OpenOptions

_MAGICS: Final = (
    b"\xd4\xc3\xb2\xa1",
    b"\xa1\xb2\xc3\xd4",
    b"\x4d\x3c\xb2\xa1",
    b"\xa1\xb2\x3c\x4d",
    b"\x0a\x0d\x0d\x0a",
)


def _open(data: LogBytes, options: OpenOptions) -> Log:
    from mavstack.logs.packets.pcap.capture_log import CaptureLog

    return CaptureLog(data, options.dialect, threads=options.threads)


def _has_signature(head: bytes) -> bool:
    return head.startswith(_MAGICS)


PCAP: Final = LogFormat("pcap", "captures of network traffic (pcap, pcapng)", _has_signature, _open)
