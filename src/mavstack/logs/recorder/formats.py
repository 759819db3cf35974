"""The formats of a recording: the bytes at the beginning of a file, and the bytes of a packet.

A tlog is a sequence of records: 8 bytes of time (microseconds since 1970, big-endian), then the packet.

A capture in the pcap format is read by Wireshark and tcpdump. It begins with a header, and each record has a
header with the time and the length. MAVLink over a serial port has no network packet, so each packet is
written as a UDP datagram from and to port 14550 of the loopback address, where Wireshark's MAVLink dissector
expects it.
"""

from __future__ import annotations

import struct
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_MICROSECONDS: Final = 1_000_000
_MAX_PCAP_SECONDS: Final = 2**32 - 1
_MAVLINK_PORT: Final = 14550
_LOOPBACK: Final = bytes([127, 0, 0, 1])
#: pcap with times in microseconds, version 2.4, packets of at most 64 KiB that begin with an IP header (101).
_PCAP_HEADER: Final = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101)
_PCAP_RECORD: Final = struct.Struct("<IIII")
_IP: Final = struct.Struct(">BBHHHBBH4s4s")
_UDP: Final = struct.Struct(">HHHH")
_TIME_SIZE: Final = 8
#: Magic byte of v2 packets, and bytes of an unsigned packet besides its payload; the second byte is the
#: payload length.
_MAGIC_V2: Final = 0xFD
_OVERHEAD_V1: Final = 8
_OVERHEAD_V2: Final = 12
_DATAGRAM_HEADERS: Final = _IP.size + _UDP.size


class Records(NamedTuple):
    """The bytes of records that follow each other, and their number."""

    data: bytes
    number: int


class RecordFormat(NamedTuple):
    """A format of recordings.

    `record` returns the record of a packet from its bytes and its time in microseconds since 1970.
    """

    suffix: str
    header: bytes
    record: Callable[[bytes, int], bytes]


def _tlog_record(packet: bytes, time: int) -> bytes:
    return time.to_bytes(8, "big") + packet


def _pcap_record(packet: bytes, time: int) -> bytes:
    seconds, microseconds = divmod(time, _MICROSECONDS)
    length = _DATAGRAM_HEADERS + len(packet)
    head = _PCAP_RECORD.pack(min(seconds, _MAX_PCAP_SECONDS), microseconds, length, length)
    # A UDP checksum of 0 means that there is none.
    udp = _UDP.pack(_MAVLINK_PORT, _MAVLINK_PORT, _UDP.size + len(packet), 0)
    return head + _ip_header(length) + udp + packet


def _ip_header(length: int) -> bytes:
    """Return the header of an IPv4 packet that carries UDP."""
    fields = (0x45, 0, length, 0, 0, 64, 17)
    words = struct.unpack(">10H", _IP.pack(*fields, 0, _LOOPBACK, _LOOPBACK))
    total = sum(words)
    total = (total & 0xFFFF) + (total >> 16)
    return _IP.pack(*fields, ~(total + (total >> 16)) & 0xFFFF, _LOOPBACK, _LOOPBACK)


def split_records(data: bytes) -> list[Records]:
    """Return the single records in the bytes of tlog records whose packets are unsigned."""
    records, start = [], 0
    while start < len(data):
        packet = start + _TIME_SIZE
        overhead = _OVERHEAD_V2 if data[packet] == _MAGIC_V2 else _OVERHEAD_V1
        end = packet + overhead + data[packet + 1]
        records.append(Records(data[start:end], 1))
        start = end
    return records


TLOG: Final = RecordFormat(".tlog", b"", _tlog_record)
PCAP: Final = RecordFormat(".pcap", _PCAP_HEADER, _pcap_record)
#: The formats by name.
RECORD_FORMATS: Final[Mapping[str, RecordFormat]] = MappingProxyType({"tlog": TLOG, "pcap": PCAP})
