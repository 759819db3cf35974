"""The header of a flight: lines `H name:value` with the definitions of the frames and the settings.

A frame has a letter: I (all values) and P (differences to the frames before) hold the main values, S slow
ones, G and H the position and the home position of satellite navigation, and E events.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property
from struct import pack, unpack
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The line with which each flight begins.
FLIGHT_MARKER: Final = b"H Product:Blackbox flight data recorder"
#: The first byte of a frame, one letter for each frame type.
MARKERS: Final = frozenset(b"IPGHES")
_MAX_LINE: Final = 1024
_FIELD: Final = re.compile(r"Field (?P<frame>[IPGHS]) (?P<kind>name|signed|predictor|encoding)")
_VERSION: Final = re.compile(r"(?P<name>\S+) (?P<major>\d+)\.(?P<minor>\d+)")
#: A clock that is not set shows the year 0.
_MIN_YEAR: Final = 2000


@dataclass(frozen=True, slots=True)
class FrameDefinition:
    """The fields of a kind of frame, in order.

    Attributes:
        names: Names of the fields, such as `gyroADC[0]`.
        signed: For each field True if its values have a sign.
        predictors: For each field the number of the predictor.
        encodings: For each field the number of the encoding.
    """

    names: tuple[str, ...]
    signed: tuple[bool, ...]
    predictors: tuple[int, ...]
    encodings: tuple[int, ...]


@dataclass(frozen=True)
class FlightHeader:
    """The header of a flight.

    Attributes:
        values: Values of the header lines by name, without the definitions of fields.
        frames: Definitions by the letter of the frame.
        end: Position of the first frame.
    """

    values: Mapping[str, str]
    frames: Mapping[str, FrameDefinition] = field(default_factory=dict)
    end: int = 0

    def numbers(self, name: str) -> list[int]:
        """Return the integers of a line, or nothing."""
        try:
            return [int(text) for text in self.values.get(name, "").split(",") if text]
        except ValueError:
            return []

    def number(self, name: str, default: int) -> int:
        """Return the first integer of a line, or the default."""
        return next(iter(self.numbers(name)), default)

    @cached_property
    def firmware(self) -> tuple[str, tuple[int, int]]:
        """Name and version of the firmware, such as ("Betaflight", (4, 5)); empty if it is not known."""
        found = _VERSION.match(self.values.get("Firmware revision", ""))
        return ("", (0, 0)) if found is None else (found["name"], (int(found["major"]), int(found["minor"])))

    @property
    def gyro_scale(self) -> float | None:
        """Degrees per second of one unit of the gyroscopes; None if it is not known."""
        text = self.values.get("gyro_scale", self.values.get("gyro.scale", ""))
        try:
            scale: float = unpack("<f", pack("<I", int(text, 16)))[0]
        except (ValueError, OverflowError, ArithmeticError):
            return None
        # Baseflight counts radians per microsecond.
        return scale if self.firmware[0] and 0 < scale < 1e6 else None

    @property
    def start_us(self) -> int | None:
        """UTC of the beginning in microseconds since 1970; None if the clock was not set."""
        try:
            moment = datetime.fromisoformat(self.values.get("Log start datetime", ""))
        except ValueError:
            return None
        if moment.year < _MIN_YEAR or moment.tzinfo is None:
            return None
        return round(moment.timestamp() * 1_000_000)


def read_header(data: bytes) -> FlightHeader:
    """Read the header of a flight.

    Args:
        data: The bytes of the flight, from its first header line.

    Returns:
        The header; its frames are those whose definitions are complete.
    """
    values: dict[str, str] = {}
    position = 0
    while position < len(data):
        if data.startswith(b"H ", position):
            end = data.find(b"\n", position, position + _MAX_LINE)
            line = data[position + 2 : end] if end >= 0 else b""
            name, colon, value = line.decode("latin-1").partition(":")
            if colon:
                values[name] = value.rstrip("\r")
            position = end + 1 if colon else position + 2
        elif data[position] in MARKERS and data[position] != ord("H"):
            break
        else:
            position += 1
    return FlightHeader(
        {name: value for name, value in values.items() if not name.startswith("Field ")},
        _frames(values),
        position,
    )


def _frames(values: Mapping[str, str]) -> dict[str, FrameDefinition]:
    lines: dict[str, dict[str, list[str]]] = {}
    for name, value in values.items():
        if found := _FIELD.fullmatch(name):
            lines.setdefault(found["frame"], {})[found["kind"]] = value.split(",") if value else []
    # P frames have the same field names and signs as I frames.
    if "P" in lines and "I" in lines:
        lines["P"] = {kind: lines["I"].get(kind, []) for kind in ("name", "signed")} | lines["P"]
    definitions = {letter: _definition(kinds) for letter, kinds in lines.items()}
    return {letter: found for letter, found in definitions.items() if found is not None}


def _definition(lines: Mapping[str, list[str]]) -> FrameDefinition | None:
    """Return a definition, or None if it is not complete."""
    names = lines.get("name", [])
    try:
        predictors, encodings, signs = (
            tuple(int(text) for text in lines.get(kind, [])) for kind in ("predictor", "encoding", "signed")
        )
    except ValueError:
        return None
    # Names with a leading underscore are reserved for additional columns.
    usable = names and all(name and name[0] != "_" for name in names) and len(set(names)) == len(names)
    if not usable or not len(names) == len(predictors) == len(encodings):
        return None
    signed = [bool(sign) for sign in signs[: len(names)]] + [False] * (len(names) - len(signs))
    return FrameDefinition(tuple(names), tuple(signed), predictors, encodings)
