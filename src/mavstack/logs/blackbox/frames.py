"""Frames: their fields are decoded, and the predictions for them are added.

A predictor says what the firmware subtracted from a value before it was encoded: the value before, the mean
of or the line through the two values before, a constant of the header, the first motor, the home position, or
the time of the last main frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.logs.blackbox.encodings import GROUPS, READERS, TAG8_4S16, TAG8_8SVB, read_tag8_4s16_v1

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.logs.blackbox.encodings import Reader
    from mavstack.logs.blackbox.header import FlightHeader, FrameDefinition

(
    ZERO,
    PREVIOUS,
    STRAIGHT_LINE,
    AVERAGE,
    MIN_THROTTLE,
    FIRST_MOTOR,
    INCREMENT,
    HOME,
    CENTRE,
    BATTERY_REFERENCE,
    MAIN_TIME,
    MIN_MOTOR,
) = range(12)
_MAX_SVB_GROUP: Final = 8
_WORD: Final = 0xFFFF_FFFF
_SIGN: Final = 0x8000_0000
_FIRST_MOTOR: Final = "motor[0]"
#: Settings of Cleanflight that a header may omit.
_DEFAULT_MIN_THROTTLE, _DEFAULT_BATTERY_REFERENCE, _CENTRE_VALUE = 1150, 4095, 1500


class UnsupportedFieldError(Exception):
    """A definition has an encoding or predictor that is not known."""


class FrameReader:
    """Reads the frames of one kind.

    Args:
        definition: The definition of the frame.
        header: The header of the flight.

    Raises:
        UnsupportedFieldError: An encoding or predictor is not known.
    """

    def __init__(self, definition: FrameDefinition, header: FlightHeader) -> None:
        self.definition = definition
        self._groups = list(_groups(definition, header.number("Data version", 2)))
        self._constants: list[tuple[int, int, bool]] = []
        self._by_predictor: dict[int, list[int]] = {number: [] for number in range(MIN_MOTOR + 1)}
        constants = _constants(header)
        for index, predictor in enumerate(definition.predictors):
            if predictor in constants:
                self._constants.append((index, constants[predictor], definition.signed[index]))
            elif predictor in self._by_predictor:
                self._by_predictor[predictor].append(index)
            else:
                raise UnsupportedFieldError(f"predictor {predictor}")
        self._motor = definition.names.index(_FIRST_MOTOR) if _FIRST_MOTOR in definition.names else None
        if self._by_predictor[FIRST_MOTOR] and self._motor is None:
            raise UnsupportedFieldError("a prediction by the first motor, which is not logged")

    @property
    def needs_home(self) -> bool:
        """True if positions are differences to the home position."""
        return bool(self._by_predictor[HOME])

    def read(self, data: bytes, position: int) -> tuple[list[int], int]:
        """Return the encoded values of a frame, and the position behind it.

        Args:
            data: The bytes of the flight.
            position: Position behind the letter of the frame.

        Raises:
            IndexError: The flight ends inside the frame.
        """
        values: list[int] = []
        for reader, count in self._groups:
            position = reader(data, position, count, values)
        return values, position

    def predict(
        self, values: list[int], previous: Sequence[int] | None, before: Sequence[int] | None, skipped: int
    ) -> None:
        """Add the predictions of a main or slow frame to its values.

        Args:
            values: The encoded values, which are changed.
            previous: The values of the last main frame, or None without one.
            before: Those of the main frame before it.
            skipped: Number of loop iterations since the last frame that are not logged.
        """
        for index, constant, signed in self._constants:
            value = values[index] + constant & _WORD
            values[index] = (value ^ _SIGN) - _SIGN if signed else value
        kinds = self._by_predictor
        if previous is not None and before is not None:
            for index in kinds[PREVIOUS]:
                values[index] += previous[index]
            for index in kinds[AVERAGE]:
                total = previous[index] + before[index]
                values[index] += total // 2 if total >= 0 else -(-total // 2)
            for index in kinds[STRAIGHT_LINE]:
                values[index] += 2 * previous[index] - before[index]
        for index in kinds[INCREMENT]:
            values[index] = skipped + 1 + (0 if previous is None else previous[index])
        if self._motor is not None:
            for index in kinds[FIRST_MOTOR]:
                values[index] += values[self._motor]

    def predict_position(self, values: list[int], home: Sequence[int], main_time: int) -> None:
        """Add the predictions of a frame of satellite navigation to its values.

        Args:
            values: The encoded values, which are changed.
            home: Latitude and longitude of the home position.
            main_time: Time of the last main frame in microseconds.
        """
        self.predict(values, None, None, 0)
        for number, index in enumerate(self._by_predictor[HOME]):
            values[index] += home[number % 2]
        for index in self._by_predictor[MAIN_TIME]:
            values[index] += main_time


def _constants(header: FlightHeader) -> dict[int, int]:
    """Return the constants by predictor."""
    low = header.number("minthrottle", _DEFAULT_MIN_THROTTLE)
    return {
        MIN_THROTTLE: low,
        CENTRE: _CENTRE_VALUE,
        BATTERY_REFERENCE: header.number("vbatref", _DEFAULT_BATTERY_REFERENCE),
        MIN_MOTOR: header.number("motorOutput", low),
    }


def _groups(definition: FrameDefinition, version: int) -> Iterator[tuple[Reader, int]]:
    """Yield the readers of successive fields with the number of fields of each."""
    encodings, predictors = definition.encodings, definition.predictors
    index = 0
    while index < len(encodings):
        encoding = encodings[index]
        if encoding not in READERS:
            raise UnsupportedFieldError(f"encoding {encoding}")
        end = index + 1
        if predictors[index] == INCREMENT:
            yield _read_zero, 1
            index = end
            continue
        limit = index + (_MAX_SVB_GROUP if encoding == TAG8_8SVB else len(encodings))
        limit = min(limit, len(encodings))
        while end < limit and encodings[end] == encoding and predictors[end] != INCREMENT:
            end += 1
        size = GROUPS.get(encoding, end - index)
        if encoding in GROUPS and index + size > len(encodings):
            raise UnsupportedFieldError(f"encoding {encoding} of {len(encodings) - index} fields")
        reader = read_tag8_4s16_v1 if encoding == TAG8_4S16 and version < 2 else READERS[encoding]
        yield reader, size
        index += size


def _read_zero(_data: bytes, position: int, _count: int, values: list[int]) -> int:
    values.append(0)
    return position
