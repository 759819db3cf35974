"""Records of measurements as text, and the calls of `External` that send them.

A line is a JSON object or comma-separated numbers. An object names the arguments of the call; `record` may
name another kind than the one of the reader. Numbers stand in the columns of a header line, or without one in
these:

    odometry, vision, mocap   time,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz
    gps, follow-target        time,latitude,longitude,altitude,vx,vy,vz
    landing-target            time,forward,right,down
    distance                  time,distance
    wind                      speed,direction,speed_accuracy,direction_accuracy
    obstacles                 time,d0,d1,d2 …

An empty number is not known, an empty time means now. Lines that start with `#` are comments.
"""

from __future__ import annotations

import json
from inspect import Parameter, signature
from math import nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.external.external import External

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping, Sequence

_POSE: Final = "time,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"
_PLACE: Final = "time,latitude,longitude,altitude,vx,vy,vz"


class RecordKind(NamedTuple):
    """A kind of record.

    Attributes:
        call: The function of `External` that sends it.
        columns: The columns of a line without a header.
    """

    call: Callable[..., Awaitable[None] | None]
    columns: str

    @property
    def is_pose(self) -> bool:
        """True for estimates of the pose, which an estimator uses or not."""
        return self.columns == _POSE


#: The kinds of records by name.
KINDS: Final[Mapping[str, RecordKind]] = MappingProxyType(
    {
        "odometry": RecordKind(External.odometry, _POSE),
        "vision": RecordKind(External.vision, _POSE),
        "mocap": RecordKind(External.mocap, _POSE),
        "gps": RecordKind(External.gps, _PLACE),
        "landing-target": RecordKind(External.landing_target, "time,forward,right,down"),
        "obstacles": RecordKind(External.obstacles, "time"),
        "distance": RecordKind(External.distance, "time,distance"),
        "follow-target": RecordKind(External.follow_target, _PLACE),
        "wind": RecordKind(External.wind, "speed,direction,speed_accuracy,direction_accuracy"),
    }
)
#: Columns that are components of an argument: the argument, and the index of the component.
_PARTS: Final[Mapping[str, tuple[str, int]]] = MappingProxyType(
    {
        column: (argument, index)
        for argument, columns in (
            ("position", "xyz"),
            ("orientation", ("qw", "qx", "qy", "qz")),
            ("velocity", ("vx", "vy", "vz")),
            ("rotation", ("wx", "wy", "wz")),
        )
        for index, column in enumerate(columns)
    }
)
_MAX_COLUMNS: Final = 200
_NUMBER_WORDS: Final = frozenset({"nan", "inf", "infinity"})


class RecordReader:
    """Reads the lines of one source.

    Args:
        kind: The kind of the records, a key of `KINDS`.
    """

    def __init__(self, kind: str) -> None:
        self._kind = kind
        self._columns = KINDS[kind].columns.split(",")

    def read(self, line: str) -> tuple[str, dict[str, Any]] | None:
        """Return the kind of a record and its arguments; None for a header, a comment or an empty line.

        Raises:
            InvalidArgumentError: The line is neither an object nor numbers.
        """
        line = line.strip()
        if not line or line.startswith("#"):
            return None
        if line.startswith("{"):
            return self._read_object(line)
        words = [word.strip() for word in line.split(",")]
        if _is_header(words):
            self._columns = words
            return None
        return self._kind, self._read_numbers(words)

    def _read_object(self, line: str) -> tuple[str, dict[str, Any]]:
        try:
            values = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise InvalidArgumentError(f"the line is not a JSON object: {error}") from None
        return str(values.pop("record", self._kind)), values

    def _read_numbers(self, words: Sequence[str]) -> dict[str, Any]:
        columns = list(self._columns)
        if self._kind == "obstacles" and len(columns) == 1:
            columns += [f"d{number}" for number in range(len(words) - 1)]
        limit = min(len(columns), _MAX_COLUMNS)
        if len(words) > limit:
            raise InvalidArgumentError(f"the line has {len(words)} numbers for {limit} columns")
        arguments: dict[str, Any] = {}
        for column, word in zip(columns, words, strict=False):
            _put(arguments, column, _number(word))
        return arguments


async def send_record(
    external: External, kind: str, values: Mapping[str, Any], defaults: Mapping[str, Any] | None = None
) -> None:
    """Send a record; a wind waits for the answer of the vehicle.

    Args:
        external: The data of the vehicle.
        kind: A key of `KINDS`.
        values: The arguments of the call; null in a list is not known, null alone leaves an argument out.
        defaults: Arguments that apply where the call has them and the record does not.

    Raises:
        InvalidArgumentError: The kind, an argument or a value is not possible.
        InvalidStateError: The connection is closed.
        RemoteError: The vehicle refused the wind, or did not answer.
    """
    if kind not in KINDS:
        raise InvalidArgumentError(f"{kind!r} is not a kind of record; kinds: {', '.join(KINDS)}")
    known = arguments_of(kind)
    given = {name: value for name, value in (defaults or {}).items() if name in known}
    given |= {name: _value(value) for name, value in values.items() if value is not None}
    unknown = sorted(given.keys() - known.keys())
    missing = [name for name, needed in known.items() if needed and name not in given]
    if unknown or missing:
        problem = f"{unknown[0]} is not an argument" if unknown else f"{missing[0]} is missing"
        raise InvalidArgumentError(f"{kind}: {problem}; arguments: {', '.join(known)}")
    try:
        answer = KINDS[kind].call(external, **given)
        if answer is not None:
            await answer
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidArgumentError(f"{kind}: {error}") from None


def arguments_of(kind: str) -> dict[str, bool]:
    """Return the arguments of a kind by their names, True where they are needed."""
    parameters = list(signature(KINDS[kind].call).parameters.values())[1:]
    return {each.name: each.default is Parameter.empty for each in parameters}


def _is_header(words: Sequence[str]) -> bool:
    return any(word[:1].isalpha() and word.lower() not in _NUMBER_WORDS for word in words)


def _number(word: str) -> float | None:
    if not word:
        return None
    try:
        return float(word)
    except ValueError:
        raise InvalidArgumentError(f"{word!r} is not a number") from None


def _put(arguments: dict[str, Any], column: str, number: float | None) -> None:
    """Put the number of a column into the argument that it belongs to."""
    if column[:1] == "d" and column[1:].isdecimal():
        arguments.setdefault("distances", []).append(number)
    elif column in _PARTS and number is not None:
        name, index = _PARTS[column]
        parts = arguments.setdefault(name, [None] * sum(part == name for part, _ in _PARTS.values()))
        parts[index] = number
    elif column not in _PARTS:
        arguments[column] = number


def _value(value: object) -> object:
    """Return a value as the calls take it: lists as tuples of numbers, whole numbers where they are whole."""
    if isinstance(value, list | tuple):
        return tuple(nan if each is None else each for each in value)
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**31:
        return int(value)
    return value
