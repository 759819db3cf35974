"""The Beast format (port 30005 of dump1090), and the extended squitters of Mode S in it.

    0x1A · type ('1' Mode A/C, '2' short, '3' long) · 6 bytes time · signal · 2, 7 or 14 bytes

A byte 0x1A inside a frame is doubled. Of long frames DF 17 and 18 are read: identification (type codes 1 to
4), positions in the air (9 to 18, 20 to 22) and velocities (19). A position is coded in compact form (CPR):
an even and an odd message within ten seconds give it. Source: ICAO Doc 9871; "The 1090 Megahertz Riddle", J.
Sun.
"""

from __future__ import annotations

from math import acos, atan2, cos, degrees, floor, hypot, pi, radians
from typing import Final, NamedTuple

from mavstack.traffic.aircraft import Report
from mavstack.traffic.units import FEET, FEET_PER_MINUTE, KNOTS

_ESCAPE: Final = 0x1A
_SIZES: Final = {0x31: 2, 0x32: 7, 0x33: 14}
_HEADER: Final = 7
_LONG: Final = 0x33
_CHARACTERS: Final = "#ABCDEFGHIJKLMNOPQRSTUVWXYZ##### ###############0123456789######"
_GENERATOR: Final = 0x1FFF409
_MAX_PAIR_TIME: Final = 10.0
_MAX_BUFFER: Final = 65_536
_SCALE: Final = 1 << 17
_MAX_AIRCRAFT: Final = 20_000


class _Coded(NamedTuple):
    latitude: int
    longitude: int
    time: float


class BeastReader:
    """Reads reports out of a stream; `now` of `feed` pairs the halves of positions."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._halves: dict[int, dict[bool, _Coded]] = {}
        #: Number of frames with a wrong checksum, and of bytes outside of frames.
        self.bad = 0

    def feed(self, data: bytes, now: float = 0.0) -> list[Report]:
        """Return the reports in the frames that the bytes complete."""
        self._buffer += data
        if len(self._buffer) > _MAX_BUFFER:
            del self._buffer[:-_MAX_BUFFER]
        reports = []
        while (frame := self._next()) is not None:
            kind, content = frame
            if kind == _LONG and (report := self._squitter(content, now)) is not None:
                reports.append(report)
        return reports

    def _next(self) -> tuple[int, bytes] | None:
        buffer = self._buffer
        while True:
            start = buffer.find(_ESCAPE)
            if start < 0 or len(buffer) < start + 2:
                self.bad += max(start, 0)
                del buffer[: max(start, 0)]
                return None
            size = _SIZES.get(buffer[start + 1])
            if size is None:
                self.bad += start + 2
                del buffer[: start + 2]  # an escaped byte inside a frame, or a frame of an unknown kind
                continue
            self.bad += start
            del buffer[:start]
            content, used = _unescaped(buffer, 2, _HEADER + size)
            if used == 0:
                return None
            kind = buffer[1]
            if len(content) < _HEADER + size:
                self.bad += used
                del buffer[:used]  # the frame is truncated: the next frame begins inside it
                continue
            del buffer[:used]
            return kind, bytes(content[_HEADER:])

    def _squitter(self, frame: bytes, now: float) -> Report | None:
        if frame[0] >> 3 not in (17, 18):
            return None
        if mode_s_remainder(frame):
            self.bad += 1
            return None
        address = int.from_bytes(frame[1:4], "big")
        message = int.from_bytes(frame[4:11], "big")
        code = message >> 51
        if 1 <= code <= 4:
            text = "".join(_CHARACTERS[message >> shift & 63] for shift in range(42, -6, -6))
            return Report(address, text.replace("#", "").strip() or None)
        if code == 19:
            return _velocity(address, message)
        if 9 <= code <= 18 or 20 <= code <= 22:
            return self._position(address, message, code >= 20, now)
        return None

    def _position(self, address: int, message: int, is_geometric: bool, now: float) -> Report:
        altitude = _altitude(message >> 36 & 0xFFF, is_geometric)
        odd = bool(message >> 34 & 1)
        if len(self._halves) >= _MAX_AIRCRAFT:
            self._halves.pop(next(iter(self._halves)))
        halves = self._halves.setdefault(address, {})
        halves[odd] = _Coded(message >> 17 & 0x1FFFF, message & 0x1FFFF, now)
        place = None
        if len(halves) == 2 and abs(halves[False].time - halves[True].time) <= _MAX_PAIR_TIME:
            place = decode_position(halves[False][:2], halves[True][:2], newest_is_odd=odd)
        latitude, longitude = place or (None, None)
        return Report(
            address,
            None,
            latitude,
            longitude,
            altitude,
            None if altitude is None else is_geometric,
        )


def mode_s_remainder(frame: bytes) -> int:
    """Return the remainder of the checksum of a frame: 0 if an extended squitter is undamaged."""
    value = int.from_bytes(frame, "big")
    for shift in range(len(frame) * 8 - 25, -1, -1):
        if value >> shift + 24 & 1:
            value ^= _GENERATOR << shift
    return value & 0xFFFFFF


def decode_position(
    even: tuple[int, int], odd: tuple[int, int], *, newest_is_odd: bool
) -> tuple[float, float] | None:
    """Return the position of a pair of compact positions in degrees; None if they are of two zones."""
    even_latitude, odd_latitude = even[0] / _SCALE, odd[0] / _SCALE
    zone = floor(59 * even_latitude - 60 * odd_latitude + 0.5)
    north = _wrapped(6.0 * (zone % 60 + even_latitude)), _wrapped(360 / 59 * (zone % 59 + odd_latitude))
    if _zones(north[0]) != _zones(north[1]) or max(map(abs, north)) > 90:
        return None
    latitude = north[newest_is_odd]
    zones = _zones(latitude)
    count = max(zones - newest_is_odd, 1)
    even_longitude, odd_longitude = even[1] / _SCALE, odd[1] / _SCALE
    index = floor(even_longitude * (zones - 1) - odd_longitude * zones + 0.5)
    longitude = 360 / count * (index % count + (odd_longitude if newest_is_odd else even_longitude))
    return latitude, longitude - 360 if longitude >= 180 else longitude


def _wrapped(latitude: float) -> float:
    return latitude - 360 if latitude >= 270 else latitude


def _zones(latitude: float) -> int:
    """Return the number of zones of longitude at a latitude (NL)."""
    magnitude = abs(latitude)
    if magnitude >= 87:
        return 2 if magnitude == 87 else 1
    if magnitude == 0:
        return 59
    ratio = 1 - (1 - cos(pi / 30)) / cos(radians(magnitude)) ** 2
    return floor(2 * pi / acos(ratio))


def _altitude(code: int, is_geometric: bool) -> float | None:
    """Return the altitude of a code of 12 bits in metres; None for codes in steps of 100 feet, or none."""
    if is_geometric:
        return float(code) if code else None
    if not code & 0x10:
        return None
    return ((code >> 5 << 4 | code & 0x0F) * 25 - 1000) * FEET


def _velocity(address: int, message: int) -> Report | None:
    subtype = message >> 48 & 7
    sign = -1 if message >> 19 & 1 else 1
    rate = message >> 10 & 0x1FF
    climb = sign * (rate - 1) * 64 * FEET_PER_MINUTE if rate else None
    if subtype not in (1, 2):
        return Report(address, climb=climb) if subtype in (3, 4) else None
    unit = KNOTS * (4 if subtype == 2 else 1)
    east, north = message >> 32 & 0x3FF, message >> 21 & 0x3FF
    if not east or not north:
        return Report(address, climb=climb)
    ve = (east - 1) * unit * (-1 if message >> 42 & 1 else 1)
    vn = (north - 1) * unit * (-1 if message >> 31 & 1 else 1)
    return Report(address, course=degrees(atan2(ve, vn)) % 360, speed=hypot(ve, vn), climb=climb)


def _unescaped(buffer: bytearray, start: int, count: int) -> tuple[bytearray, int]:
    """Return up to `count` bytes without escapes, and the bytes that they took; (…, 0): more must arrive."""
    content, at = bytearray(), start
    while len(content) < count:
        if at >= len(buffer):
            return content, 0
        if buffer[at] == _ESCAPE:
            if at + 1 >= len(buffer):
                return content, 0
            if buffer[at + 1] != _ESCAPE:
                return content, at
            at += 1
        content.append(buffer[at])
        at += 1
    return content, at
