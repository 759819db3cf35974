"""Tlogs for tests, with packets whose framing is valid and whose checksums are not."""

from __future__ import annotations


def packet(payload: bytes, version: int = 2, signed: bool = False) -> bytes:
    if version == 1:
        return bytes([0xFE, len(payload), 0, 1, 1, 0]) + payload + b"\xaa\xbb"
    header = bytes([0xFD, len(payload), int(signed), 0, 0, 1, 1, 0, 0, 0])
    return header + payload + b"\xaa\xbb" + (bytes(13) if signed else b"")


def entry(time: float, data: bytes) -> bytes:
    return round(time * 1e6).to_bytes(8, "big") + data


def tlog(times, payload: bytes = b"x" * 20) -> bytes:
    return b"".join(entry(time, packet(payload)) for time in times)
