"""UDP datagrams and TCP segments in frames of all link types."""

from __future__ import annotations

from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.logs.packets.pcap.datagrams import Segment, address_text, read_segment
from tests.logs.packets.pcap.captures import CLIENT, SERVER, ethernet, ip, tcp, udp

V6 = ((bytes(15) + b"\x01", 1), (bytes(15) + b"\x02", 2))
DATAGRAM = Segment("udp", CLIENT, SERVER, b"data")


@pytest.mark.parametrize(
    ("link_type", "head"),
    [
        (101, b""),
        (228, b""),
        (0, pack("<I", 2)),
        (108, pack(">I", 2)),
        (113, bytes(14) + b"\x08\x00"),
        (276, b"\x08\x00" + bytes(18)),
        (1, ethernet(udp(b""))[:14]),
        (1, ethernet(udp(b""), 0x8100)[:18]),
        (1, ethernet(udp(b""), 0x88A8, 0x8100)[:22]),
    ],
)
def test_link_types(link_type, head):
    assert read_segment(link_type, head + udp(b"data")) == DATAGRAM


def test_padding_of_short_ethernet_frames_is_no_data():
    assert read_segment(1, ethernet(udp(b"data")) + bytes(14)) == DATAGRAM


def test_ipv6():
    assert read_segment(1, ethernet(udp(b"data", *V6))) == Segment("udp", *V6, b"data")
    datagram = udp(b"data", *V6)[40:]
    extended = ip(0, pack(">BB6x", 43, 0) + pack(">BB14x", 17, 1) + datagram, *V6)
    assert read_segment(101, extended) == Segment("udp", *V6, b"data")


def test_tcp():
    assert read_segment(101, tcp(b"data", 99)) == Segment("tcp", CLIENT, SERVER, b"data", 99)
    opening = read_segment(101, tcp(b"", 2**32 - 1, flags=2))
    assert opening == Segment("tcp", CLIENT, SERVER, b"", 0, True)


@pytest.mark.parametrize(
    "frame",
    [b"", b"\x45", udp(b"")[:22], ip(1, b"ping"), ip(17, b"part", fragment=0x2000), b"\x55" + udp(b"")[1:]],
)
def test_frames_without_data(frame):
    assert read_segment(101, frame) is None
    assert read_segment(147, udp(b"data")) is None
    assert read_segment(1, bytes(12) + b"\x08\x06" + udp(b"data")) is None


@given(st.sampled_from([0, 1, 101, 113, 276, 500]), st.binary(max_size=120))
def test_any_bytes_are_read(link_type, frame):
    read_segment(link_type, frame)


def test_addresses_as_text():
    assert address_text(SERVER) == "10.0.0.2:14550"
    assert address_text(V6[0]) == "[::1]:1"
