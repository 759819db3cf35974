"""GDL 90, the format of ADS-B receivers for tablets: datagrams with frames between flag bytes.

    0x7E · id · content · CRC-16 · 0x7E        0x7D escapes 0x7E and 0x7D, xor 0x20

Traffic (20) and the own position (10) have one layout. Source: Garmin, GDL 90 data interface, 560-1058-00.
"""

from __future__ import annotations

from typing import Final

from mavstack.traffic.aircraft import Report
from mavstack.traffic.units import FEET, KNOTS

_FLAG, _ESCAPE = 0x7E, 0x7D
_TRAFFIC, _TRAFFIC_SIZE = 20, 28
_MAX_FRAME: Final = 1024
_UNKNOWN_12, _UNKNOWN_CLIMB = 0xFFF, 0x800
_CLIMB_UNIT: Final = 64 * FEET / 60


class Gdl90Reader:
    """Reads reports of traffic."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        #: Number of frames with a wrong checksum or a wrong size.
        self.bad = 0

    def feed(self, data: bytes) -> list[Report]:
        """Return the reports in the frames that the bytes complete."""
        self._buffer += data
        *frames, rest = bytes(self._buffer).split(bytes((_FLAG,)))
        self._buffer = bytearray(rest[-_MAX_FRAME:])
        return [report for frame in frames if frame and (report := self._report(frame)) is not None]

    def _report(self, frame: bytes) -> Report | None:
        content = _unescaped(frame)
        if len(content) < 3 or gdl90_crc(content[:-2]) != int.from_bytes(content[-2:], "little"):
            self.bad += 1
            return None
        if content[0] != _TRAFFIC:
            return None
        if len(content) != _TRAFFIC_SIZE + 2:
            self.bad += 1
            return None
        return _traffic(content[:-2])


def gdl90_crc(data: bytes) -> int:
    """Return the CRC of a frame, as the tables of the specification compute it."""
    crc = 0
    for byte in data:
        crc = _TABLE[crc >> 8] ^ (crc << 8 & 0xFFFF) ^ byte
    return crc


def gdl90_frame(content: bytes) -> bytes:
    """Return the frame of a content with its id."""
    body = content + gdl90_crc(content).to_bytes(2, "little")
    escaped = bytearray()
    for byte in body:
        escaped += bytes((_ESCAPE, byte ^ 0x20)) if byte in (_FLAG, _ESCAPE) else bytes((byte,))
    return bytes((_FLAG,)) + bytes(escaped) + bytes((_FLAG,))


def _traffic(content: bytes) -> Report:
    altitude = int.from_bytes(content[11:13], "big") >> 4
    speed = int.from_bytes(content[14:16], "big") >> 4
    climb = int.from_bytes(content[15:17], "big") & 0xFFF
    misc = content[12] & 0x0F
    callsign = content[19:27].decode("ascii", "replace").strip()
    return Report(
        int.from_bytes(content[2:5], "big"),
        callsign or None,
        _angle(content[5:8]),
        _angle(content[8:11]),
        None if altitude == _UNKNOWN_12 else (altitude * 25 - 1000) * FEET,
        False,
        content[17] * 360 / 256 if misc & 3 == 1 else None,
        None if speed == _UNKNOWN_12 else speed * KNOTS,
        None if climb == _UNKNOWN_CLIMB else (climb - (climb >> 11 << 12)) * _CLIMB_UNIT,
    )


def _angle(data: bytes) -> float:
    return int.from_bytes(data, "big", signed=True) * 180 / (1 << 23)


def _unescaped(frame: bytes) -> bytes:
    content, escaped = bytearray(), False
    for byte in frame:
        if byte == _ESCAPE and not escaped:
            escaped = True
            continue
        content.append(byte ^ 0x20 if escaped else byte)
        escaped = False
    return bytes(content)


def _crc_table() -> tuple[int, ...]:
    table = []
    for index in range(256):
        crc = index << 8
        for _ in range(8):
            crc = (crc << 1 ^ (0x1021 if crc & 0x8000 else 0)) & 0xFFFF
        table.append(crc)
    return tuple(table)


_TABLE: Final = _crc_table()
