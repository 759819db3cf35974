"""Packets built byte by byte from the specification, without the code under test."""

from __future__ import annotations

import hashlib


def crc(data: bytes) -> int:
    """Calculate the CRC-16/MCRF4XX bit by bit: reflected polynomial 0x1021, initial value 0xFFFF."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ 0x8408 if value & 1 else value >> 1
    return value


def _with_checksum(head_and_payload: bytes, crc_extra: int) -> bytes:
    return head_and_payload + crc(head_and_payload[1:] + bytes([crc_extra])).to_bytes(2, "little")


def version_1(message_id, payload, crc_extra, *, system=1, component=1, sequence=0):
    """Build a MAVLink 1 packet."""
    return _with_checksum(
        bytes([0xFE, len(payload), sequence, system, component, message_id]) + payload, crc_extra
    )


def version_2(message_id, payload, crc_extra, *, system=1, component=1, sequence=0, incompat=0, compat=0):
    """Build a MAVLink 2 packet with the payload as given."""
    head = bytes([0xFD, len(payload), incompat, compat, sequence, system, component])
    return _with_checksum(head + message_id.to_bytes(3, "little") + payload, crc_extra)


def signed(packet: bytes, key: bytes, link_id: int, timestamp: int) -> bytes:
    """Append the signature to a packet built with `incompat=1`."""
    packet += bytes([link_id]) + timestamp.to_bytes(6, "little")
    return packet + hashlib.sha256(key + packet).digest()[:6]
