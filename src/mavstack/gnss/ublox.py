"""u-blox receivers as reference stations: configuration and progress of a survey, by pyubx2.

    SurveyIn(duration=60, accuracy=2.0)             # measures its own position first
    FixedPosition(47.3977418, 8.5455938, 535.2)     # knows it

Receivers of generation 9 and later are configured by UBX-CFG-VALSET in RAM alone, so that the next start
finds them as they were. Source: u-blox, ZED-F9P interface description.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple

from mavstack.errors import InvalidArgumentError, MissingExtraError

_RAM: Final = 1
_SURVEY_IN, _FIXED = 1, 2
_GEODETIC: Final = 1
_HEADER: Final = b"\xb5\x62"
_ENVELOPE: Final = 8
_MAX_PAYLOAD: Final = 8192
#: RTCM messages that a base sends, and their intervals in epochs of one second.
_MESSAGES: Final = {1005: 5, 1074: 1, 1084: 1, 1094: 1, 1124: 1, 1230: 5}
_PORTS: Final = ("USB", "UART1")


class SurveyIn(NamedTuple):
    """A base that measures its own position: at least `duration` seconds, until `accuracy` metres."""

    duration: float = 60.0
    accuracy: float = 2.0


class FixedPosition(NamedTuple):
    """A base at a known position: degrees, and metres above the ellipsoid."""

    latitude: float
    longitude: float
    height: float


class SurveyState(NamedTuple):
    """The progress of a survey: seconds, metres, and whether the base has its position."""

    duration: int
    accuracy: float
    is_valid: bool
    is_active: bool


def base_configuration(mode: SurveyIn | FixedPosition) -> bytes:
    """Return the message that makes a receiver a base, which sends RTCM at USB and its first serial port.

    Raises:
        InvalidArgumentError: A value is out of range.
        MissingExtraError: pyubx2 is not installed.
    """
    values = _survey(mode) if isinstance(mode, SurveyIn) else _fixed(mode)
    for port in _PORTS:
        values += [(f"CFG_MSGOUT_RTCM_3X_TYPE{number}_{port}", rate) for number, rate in _MESSAGES.items()]
        values += [(f"CFG_MSGOUT_UBX_NAV_SVIN_{port}", 1)]
    data: bytes = _library().UBXMessage.config_set(_RAM, 0, values).serialize()
    return data


def _survey(mode: SurveyIn) -> list[tuple[str, int]]:
    if not 1 <= mode.duration <= 86_400 or not 0.01 <= mode.accuracy <= 1000:
        raise InvalidArgumentError("a survey takes 1 to 86400 seconds and ends at 0.01 to 1000 m")
    return [
        ("CFG_TMODE_MODE", _SURVEY_IN),
        ("CFG_TMODE_SVIN_MIN_DUR", round(mode.duration)),
        ("CFG_TMODE_SVIN_ACC_LIMIT", round(mode.accuracy * 1e4)),
    ]


def _fixed(mode: FixedPosition) -> list[tuple[str, int]]:
    if not (abs(mode.latitude) <= 90 and abs(mode.longitude) <= 180 and -1000 <= mode.height <= 20_000):
        raise InvalidArgumentError("the position of the base must be on Earth, in degrees and metres")
    values = [("CFG_TMODE_MODE", _FIXED), ("CFG_TMODE_POS_TYPE", _GEODETIC)]
    for name, value in (("LAT", mode.latitude * 1e9), ("LON", mode.longitude * 1e9)):
        coarse, fine = _split(value)
        values += [(f"CFG_TMODE_{name}", coarse), (f"CFG_TMODE_{name}_HP", fine)]
    coarse, fine = _split(mode.height * 1e4)
    return [*values, ("CFG_TMODE_HEIGHT", coarse), ("CFG_TMODE_HEIGHT_HP", fine)]


def _split(value: float) -> tuple[int, int]:
    """Return a value as hundreds and rest, the two fields of a position of high precision."""
    whole = round(value)
    coarse = round(whole / 100)
    return coarse, whole - 100 * coarse


class UbxFramer:
    """Finds the progress of a survey (UBX-NAV-SVIN) in the bytes of a receiver."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[SurveyState]:
        """Return the states that the bytes complete."""
        self._buffer += data
        states = []
        while (message := self._next()) is not None:
            if message[2:4] == b"\x01\x3b" and len(message) == 40 + _ENVELOPE:
                states.append(_survey_state(message[6:-2]))
        return states

    def _next(self) -> bytes | None:
        buffer = self._buffer
        while (start := buffer.find(_HEADER)) >= 0:
            del buffer[:start]
            if len(buffer) < _ENVELOPE:
                return None
            size = int.from_bytes(buffer[4:6], "little")
            if size > _MAX_PAYLOAD:
                del buffer[:1]
                continue
            if len(buffer) < size + _ENVELOPE:
                return None
            message = bytes(buffer[: size + _ENVELOPE])
            if _fletcher(message[2:-2]) == message[-2:]:
                del buffer[: len(message)]
                return message
            del buffer[:1]
        del buffer[: max(len(buffer) - 1, 0)]
        return None


def _fletcher(data: bytes) -> bytes:
    first = second = 0
    for byte in data:
        first = (first + byte) & 0xFF
        second = (second + first) & 0xFF
    return bytes((first, second))


def _survey_state(payload: bytes) -> SurveyState:
    duration, accuracy = int.from_bytes(payload[8:12], "little"), int.from_bytes(payload[28:32], "little")
    return SurveyState(duration, accuracy / 1e4, bool(payload[36]), bool(payload[37]))


def _library() -> Any:  # noqa: ANN401 (a module without types)
    try:
        import pyubx2
    except ImportError:
        raise MissingExtraError("a u-blox base", "rtk") from None
    return pyubx2
