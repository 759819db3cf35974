"""The bytes of recordings, in the formats that other programs read."""

from __future__ import annotations

import struct

from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.logs.recorder.formats import PCAP, RECORD_FORMATS, TLOG, Records, split_records
from mavstack.wire import Encoder

MAX_TIME = 2**63 - 1


def test_a_record_of_a_tlog_is_the_time_and_the_packet() -> None:
    assert TLOG.header == b""
    assert TLOG.record(b"packet", 0x0102) == b"\0\0\0\0\0\0\1\2packet"


def test_formats_are_found_by_their_suffix() -> None:
    assert {name: each.suffix for name, each in RECORD_FORMATS.items()} == {"tlog": ".tlog", "pcap": ".pcap"}


def ones_complement_sum(data: bytes) -> int:
    total = sum(struct.unpack(f">{len(data) // 2}H", data))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return total


@given(st.binary(max_size=280), st.integers(0, MAX_TIME))
def test_a_record_of_a_capture_is_a_udp_datagram(packet: bytes, time: int) -> None:
    record = PCAP.record(packet, time)
    seconds, microseconds, captured, length = struct.unpack("<IIII", record[:16])
    assert (seconds, microseconds) == (min(time // 10**6, 2**32 - 1), time % 10**6)
    assert captured == length == len(record) - 16
    header, datagram = record[16:36], record[36:]
    assert header[0] == 0x45
    assert header[9] == 17
    assert int.from_bytes(header[2:4], "big") == length
    assert ones_complement_sum(header) == 0xFFFF
    assert struct.unpack(">HHHH", datagram[:8]) == (14550, 14550, len(packet) + 8, 0)
    assert datagram[8:] == packet


def test_the_header_of_a_capture_declares_ip_packets() -> None:
    magic, major, minor, _, _, _, link_type = struct.unpack("<IHHiIII", PCAP.header)
    assert (magic, major, minor, link_type) == (0xA1B2C3D4, 2, 4, 101)


def test_the_checksum_of_every_length_is_right():
    for length in range(280):
        header = PCAP.record(bytes(length), 0)[16:36]
        total = sum(int.from_bytes(header[place : place + 2], "big") for place in range(0, 20, 2))
        assert (total & 0xFFFF) + (total >> 16) == 0xFFFF


def test_records_that_follow_each_other_are_split():
    packets = [
        Encoder(1, 1, version=version).encode(common.Attitude(roll=roll))
        for version in (1, 2)
        for roll in (0, 1)
    ]
    records = [TLOG.record(packet, 7) for packet in packets]
    assert split_records(b"".join(records)) == [Records(record, 1) for record in records]
    assert split_records(b"") == []
