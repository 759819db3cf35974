"""BaseStation's format (SBS-1, port 30003 of dump1090): a line of text for each message.

    MSG,3,1,1,4CA2D6,1,2026/11/28,12:00:00.000,2026/11/28,12:00:00.000,,37000,,,47.39,8.54,,,0,0,0,0

Fields: 4 address, 10 callsign, 11 altitude in feet, 12 speed in knots, 13 track, 14 and 15 position, 16 climb
in feet per minute, 17 squawk.
"""

from __future__ import annotations

from typing import Final

from mavstack.traffic.aircraft import Report
from mavstack.traffic.units import FEET, FEET_PER_MINUTE, KNOTS

_MAX_LINE: Final = 512
_FIELDS: Final = 18


class SbsReader:
    """Reads reports out of a stream of lines."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        #: Number of lines that are not messages of aircraft.
        self.bad = 0

    def feed(self, data: bytes) -> list[Report]:
        """Return the reports in the lines that the bytes complete."""
        self._buffer += data
        *lines, rest = bytes(self._buffer).split(b"\n")
        self._buffer = bytearray(rest[-_MAX_LINE:])
        reports = [_report(line[:_MAX_LINE]) for line in lines if line.strip()]
        self.bad += reports.count(None)
        return [report for report in reports if report is not None]


def _report(line: bytes) -> Report | None:
    fields = line.decode("ascii", "replace").strip().split(",")
    if fields[0] != "MSG" or len(fields) < _FIELDS:
        return None
    try:
        address = int(fields[4], 16)
    except ValueError:
        return None
    if not 0 < address < 1 << 24:
        return None
    climb = _number(fields[16])
    squawk = fields[17].strip()
    altitude, speed = _number(fields[11]), _number(fields[12])
    return Report(
        address,
        fields[10].strip()[:8] or None,
        _number(fields[14]),
        _number(fields[15]),
        None if altitude is None else altitude * FEET,
        None if altitude is None else False,
        _number(fields[13]),
        None if speed is None else speed * KNOTS,
        None if climb is None else climb * FEET_PER_MINUTE,
        int(squawk) if squawk.isascii() and squawk.isdigit() and len(squawk) <= 4 else None,
    )


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if abs(value) < 1e6 else None
