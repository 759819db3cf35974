"""The formats of packets, which have no signature: a file is searched for packets and their times."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.logs.registry import LogFormat

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.logs.options import OpenOptions


def open_packets(data: LogBytes, options: OpenOptions) -> Log:
    """Open a log of packets; `options.timestamped` None detects from the content whether it is a tlog.

    Args:
        data: The bytes of the file.
        options: The options.
    """
    from mavstack.logs.packets.packet_log import PacketLog

    return PacketLog(data, options.dialect, timestamped=options.timestamped, threads=options.threads)


def _open_tlog(data: LogBytes, options: OpenOptions) -> Log:
    from mavstack.logs.packets.packet_log import PacketLog

    return PacketLog(data, options.dialect, timestamped=True, threads=options.threads)


def _open_raw(data: LogBytes, options: OpenOptions) -> Log:
    from mavstack.logs.packets.packet_log import PacketLog

    return PacketLog(data, options.dialect, timestamped=False, threads=options.threads)


def _has_signature(_head: bytes) -> bool:
    return False


TLOG: Final = LogFormat("tlog", "packets with a time before each", _has_signature, _open_tlog)
RAW: Final = LogFormat("raw", "packets without times", _has_signature, _open_raw)
