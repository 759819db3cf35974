"""Frames: their fields are decoded, and the predictions for them are added.

A predictor says what the firmware subtracted from a value before it was encoded: the value before, the mean
of or the line through the two values before, a constant of the header, the first motor, the home position, or
the time of the last main frame.
"""

from __future__ import annotations

from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.logs.blackbox.compiled import compile_decoder
from mavstack.logs.blackbox.encodings import GROUPS, NOTHING, READERS, TAG8_4S16, TAG8_8SVB, read_tag8_4s16_v1

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from mavstack.logs.blackbox.compiled import Decoder
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
#: The terms that each of the other predictors adds to a value; position predictors use other frames.
_ADDED: Final[Mapping[int, tuple[str, ...]]] = MappingProxyType(
    {
        ZERO: (),
        PREVIOUS: ("previous[{}]",),
        STRAIGHT_LINE: ("2 * previous[{0}] - before[{0}]",),
        INCREMENT: ("skipped + 1 + previous[{}]",),
        HOME: (),
        MAIN_TIME: (),
    }
)
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
        self._predictions = list(_predictions(definition, _constants(header)))
        self._nothing = [0] * len(definition.names)
        self._home = [index for index, number in enumerate(definition.predictors) if number == HOME]
        self._main_time = [index for index, number in enumerate(definition.predictors) if number == MAIN_TIME]

    @cached_property
    def decode(self) -> Decoder:
        """The function that decodes a frame, made when the first one is read."""
        return compile_decoder(self._groups, self._predictions)

    @property
    def needs_home(self) -> bool:
        """True if positions are differences to the home position."""
        return bool(self._home)

    def read(self, data: bytes, position: int) -> tuple[list[int], int]:
        """Return the values of a frame that does not depend on others, and the position behind it.

        Args:
            data: The bytes of the flight.
            position: Position behind the letter of the frame.

        Raises:
            IndexError: The flight ends inside the frame.
        """
        return self.decode(data, position, self._nothing, self._nothing, 0)

    def add_position(self, values: list[int], home: Sequence[int], main_time: int) -> None:
        """Add what a frame of satellite navigation is relative to.

        Args:
            values: The values, which are changed.
            home: Latitude and longitude of the home position.
            main_time: Time of the last main frame in microseconds.
        """
        for number, index in enumerate(self._home):
            values[index] += home[number % 2]
        for index in self._main_time:
            values[index] += main_time


def _predictions(definition: FrameDefinition, constants: Mapping[int, int]) -> Iterator[str]:
    """Yield the statements that add the predictions; those by the first motor are the last ones."""
    names = definition.names
    motor = f"v{names.index(_FIRST_MOTOR)}" if _FIRST_MOTOR in names else ""
    last = []
    for index, predictor in enumerate(definition.predictors):
        value = f"v{index}"
        if predictor in constants:
            yield f"{value} = {value} + {constants[predictor] & _WORD} & {_WORD}"
            if definition.signed[index]:
                yield f"{value} = ({value} ^ {_SIGN}) - {_SIGN}"
        elif predictor == FIRST_MOTOR and motor:
            last.append(f"{value} += {motor}")
        elif predictor == AVERAGE:
            # Division by two rounds towards zero.
            yield f"total = previous[{index}] + before[{index}]"
            yield f"{value} += total + (total < 0) >> 1"
        elif predictor in _ADDED:
            yield from (f"{value} += {term.format(index)}" for term in _ADDED[predictor])
        else:
            raise UnsupportedFieldError(f"predictor {predictor}")
    yield from last


def _constants(header: FlightHeader) -> dict[int, int]:
    """Return the constants by predictor."""
    low = header.number("minthrottle", _DEFAULT_MIN_THROTTLE)
    return {
        MIN_THROTTLE: low,
        CENTRE: _CENTRE_VALUE,
        BATTERY_REFERENCE: header.number("vbatref", _DEFAULT_BATTERY_REFERENCE),
        MIN_MOTOR: header.number("motorOutput", low),
    }


def _groups(definition: FrameDefinition, version: int) -> Iterator[tuple[int, Reader, int]]:
    """Yield the encoding and the reader of successive fields, with the number of fields of each."""
    encodings, predictors = definition.encodings, definition.predictors
    index = 0
    while index < len(encodings):
        encoding = encodings[index]
        if encoding not in READERS:
            raise UnsupportedFieldError(f"encoding {encoding}")
        end = index + 1
        if predictors[index] == INCREMENT:
            yield NOTHING, READERS[NOTHING], 1
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
        yield encoding, reader, size
        index += size
