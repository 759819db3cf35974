"""Sentences of NMEA 0183: positions for casters, chart plotters and gpsd, and a framer for received ones.

$GPGGA,120000.00,4723.8620,N,00832.7360,E,4,14,0.6,488.0,M,47.0,M,,*5C
"""

from __future__ import annotations

from math import floor
from typing import Final, NamedTuple

#: Maximum length of a sentence; the standard allows 82 characters, but receivers send more.
MAX_SENTENCE: Final = 256
_KNOTS: Final = 3600 / 1852
_SECONDS_OF_DAY: Final = 86_400

#: The quality field of GGA by GPS_FIX_TYPE: 0 no fix, 1 GPS, 2 differential, 5 RTK float, 4 RTK fixed, static
#: or PPP.
_QUALITY: Final = (0, 0, 1, 1, 2, 5, 4, 4, 4)


class Fix(NamedTuple):
    """A position for sentences.

    Attributes:
        time: Unix seconds.
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.
        fix_type: The GPS_FIX_TYPE.
        satellites: The number of satellites.
        hdop: Horizontal dilution of precision.
        separation: The height of the geoid above the ellipsoid, in metres.
    """

    time: float
    latitude: float
    longitude: float
    altitude: float
    fix_type: int = 3
    satellites: int = 0
    hdop: float = 1.0
    separation: float = 0.0


def sentence(body: str) -> bytes:
    """Return a sentence with its `$`, its checksum and its line end."""
    return f"${body}*{_checksum(body.encode('ascii', 'replace')):02X}\r\n".encode("ascii", "replace")


def format_gga(fix: Fix) -> bytes:
    """Return the GGA sentence of a position."""
    quality = _QUALITY[min(max(fix.fix_type, 0), len(_QUALITY) - 1)]
    place = f"{_angle(fix.latitude, 'NS', 2)},{_angle(fix.longitude, 'EW', 3)}"
    return sentence(
        f"GPGGA,{_clock(fix.time)},{place},{quality},{min(max(fix.satellites, 0), 99):02d},"
        f"{min(max(fix.hdop, 0.0), 99.9):.1f},{fix.altitude:.2f},M,{fix.separation:.1f},M,,"
    )


def format_rmc(fix: Fix, speed: float = 0.0, course: float | None = None) -> bytes:
    """Return the RMC sentence of a position, with its speed in m/s and its course in degrees."""
    place = f"{_angle(fix.latitude, 'NS', 2)},{_angle(fix.longitude, 'EW', 3)}"
    valid, mode = ("A", "A") if fix.fix_type >= 2 else ("V", "N")
    bearing = "" if course is None else f"{round(course * 10) % 3600 / 10:.1f}"
    date = _date(fix.time)
    return sentence(
        f"GPRMC,{_clock(fix.time)},{valid},{place},{speed * _KNOTS:.2f},{bearing},{date},,,{mode}"
    )


class NmeaFramer:
    """Finds sentences with a right checksum in a stream of bytes."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        #: Number of lines that are not sentences, or have a wrong checksum.
        self.bad_lines = 0

    def feed(self, data: bytes) -> list[str]:
        """Return the bodies of the sentences that the bytes complete, without `$` and checksum."""
        self._buffer += data
        *lines, rest = bytes(self._buffer).split(b"\n")
        self._buffer = bytearray(rest[-MAX_SENTENCE:])
        bodies = [_body(line.strip()) for line in lines if line.strip()]
        self.bad_lines += bodies.count(None)
        return [body for body in bodies if body is not None]


def _body(line: bytes) -> str | None:
    start = line.rfind(b"$")
    body, star, checksum = line[start + 1 :].partition(b"*")
    if start < 0 or not star or len(line) > MAX_SENTENCE or len(checksum) != 2:
        return None
    try:
        expected = int(checksum, 16)
    except ValueError:
        return None
    return body.decode("ascii", "replace") if expected == _checksum(body) else None


def _checksum(body: bytes) -> int:
    value = 0
    for byte in body:
        value ^= byte
    return value


def _angle(degrees: float, letters: str, digits: int) -> str:
    """Return degrees and minutes with the letter of their half of the Earth."""
    total = round(
        abs(degrees) * 60e7
    )  # in 1e-7 minutes; rounded before the division, so that 60 minutes cannot appear
    whole, minutes = divmod(total, 600_000_000)
    return f"{whole:0{digits}d}{minutes / 1e7:010.7f},{letters[degrees < 0]}"


def _clock(time: float) -> str:
    hundredths = floor(time * 100) % (_SECONDS_OF_DAY * 100)
    minutes, rest = divmod(hundredths, 6000)
    hours, minutes = divmod(minutes, 60)
    return f"{hours:02d}{minutes:02d}{rest / 100:05.2f}"


def _date(time: float) -> str:
    """Return the day, month and year of Unix seconds (proleptic Gregorian calendar, by Hinnant's method)."""
    days = floor(time / _SECONDS_OF_DAY) + 719_468
    era, day_of_era = divmod(days, 146_097)
    year_of_era = (day_of_era - day_of_era // 1460 + day_of_era // 36_524 - day_of_era // 146_096) // 365
    day_of_year = day_of_era - (365 * year_of_era + year_of_era // 4 - year_of_era // 100)
    month = (5 * day_of_year + 2) // 153
    day = day_of_year - (153 * month + 2) // 5 + 1
    number = month + 3 if month < 10 else month - 9
    year = year_of_era + era * 400 + (number <= 2)
    return f"{day:02d}{number:02d}{year % 100:02d}"
