"""The UDP datagrams and TCP segments in frames of the usual link types.

Ethernet (with VLAN tags), raw IP, Linux cooked capture (versions 1 and 2) and the loopback device of BSD;
IPv4 and IPv6. Fragments of IP packets are not joined: no MAVLink packet is as long as a fragment.
"""

from __future__ import annotations

from ipaddress import ip_address
from struct import error, unpack_from
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

_IPV4, _IPV6 = 0x0800, 0x86DD
_VLAN_TAGS: Final = frozenset({0x8100, 0x88A8, 0x9100})
_TCP, _UDP = 6, 17
_IPV4_HEADER, _IPV6_HEADER, _UDP_HEADER, _TCP_HEADER = 20, 40, 8, 20
#: Extension headers of IPv6 with a length in units of 8 bytes: hop by hop, routing, destination.
_EXTENSIONS: Final = frozenset({0, 43, 60})
_MAX_EXTENSIONS: Final = 8


class Segment(NamedTuple):
    """A UDP datagram or a TCP segment.

    Attributes:
        protocol: "udp" or "tcp".
        source: Address and port of the sender.
        target: Address and port of the receiver.
        payload: The data.
        sequence: Sequence number of the first byte of a TCP segment.
        starts: True for the segment that opens a TCP connection.
    """

    protocol: str
    source: tuple[bytes, int]
    target: tuple[bytes, int]
    payload: bytes
    sequence: int = 0
    starts: bool = False


def address_text(address: tuple[bytes, int]) -> str:
    """Return an address and a port as text, such as `127.0.0.1:14550` or `[::1]:14550`."""
    host = str(ip_address(address[0]))
    return f"[{host}]:{address[1]}" if ":" in host else f"{host}:{address[1]}"


def read_segment(link_type: int, frame: bytes) -> Segment | None:
    """Return the datagram or segment in a frame, or None if it holds none that can be read.

    Args:
        link_type: Link type of the capture.
        frame: The bytes of the frame.
    """
    unwrap = _LINK_TYPES.get(link_type)
    try:
        return None if unwrap is None else _read_ip(unwrap(frame))
    except (error, IndexError):
        return None


def _ethernet(frame: bytes) -> bytes:
    position = 12
    while unpack_from(">H", frame, position)[0] in _VLAN_TAGS:
        position += 4
    return _ip_of(unpack_from(">H", frame, position)[0], frame[position + 2 :])


def _cooked(frame: bytes) -> bytes:
    return _ip_of(unpack_from(">H", frame, 14)[0], frame[16:])


def _cooked_2(frame: bytes) -> bytes:
    return _ip_of(unpack_from(">H", frame)[0], frame[20:])


def _ip_of(protocol: int, packet: bytes) -> bytes:
    return packet if protocol in (_IPV4, _IPV6) else b""


def _loopback(frame: bytes) -> bytes:
    """Leave out the address family, whose byte order and values differ between systems."""
    return frame[4:]


_LINK_TYPES: Final[dict[int, Callable[[bytes], bytes]]] = {
    0: _loopback,
    1: _ethernet,
    **dict.fromkeys((12, 14, 101, 228, 229), bytes),
    108: _loopback,
    113: _cooked,
    276: _cooked_2,
}


def _read_ip(packet: bytes) -> Segment | None:
    version = packet[0] >> 4
    if version == 4:
        return _read_ipv4(packet)
    return _read_ipv6(packet) if version == 6 else None


def _read_ipv4(packet: bytes) -> Segment | None:
    header, total = (packet[0] & 15) * 4, unpack_from(">H", packet, 2)[0]
    is_fragment = unpack_from(">H", packet, 6)[0] & 0x3FFF
    if header < _IPV4_HEADER or is_fragment:
        return None
    # The length is 0 if the network card splits large segments.
    body = packet[header : total or None]
    return _read_transport(packet[9], packet[12:16], packet[16:20], body)


def _read_ipv6(packet: bytes) -> Segment | None:
    protocol, length = packet[6], unpack_from(">H", packet, 4)[0]
    body = packet[_IPV6_HEADER : _IPV6_HEADER + length if length else None]
    for _ in range(_MAX_EXTENSIONS):
        if protocol not in _EXTENSIONS:
            break
        protocol, body = body[0], body[8 + body[1] * 8 :]
    return _read_transport(protocol, packet[8:24], packet[24:40], body)


def _read_transport(protocol: int, source: bytes, target: bytes, body: bytes) -> Segment | None:
    if protocol not in (_TCP, _UDP):
        return None
    source_port, target_port = unpack_from(">2H", body)
    ends = ((source, source_port), (target, target_port))
    if protocol == _UDP:
        (length,) = unpack_from(">H", body, 4)
        return Segment("udp", *ends, body[_UDP_HEADER : length or None])
    (sequence,) = unpack_from(">I", body, 4)
    header = (body[12] >> 4) * 4
    if header < _TCP_HEADER:
        return None
    starts = bool(body[13] & 2)
    return Segment("tcp", *ends, body[header:], sequence + starts & 0xFFFF_FFFF, starts)
