"""Messages of different rates on one time axis: resampling, and as-of joins.

A column is named as in `ATTITUDE.roll`, `BATTERY_STATUS[1].voltages[0]` (an instance, an element) or
`vehicle_status.nav_state`. Rows are put in the order of time (rows of one time stay in the order of the
file), and rows of unknown time are left out. Numbers of matched rows are float64, so that NaN can stand for
"no value"; integers beyond 2**53 lose digits. Linear interpolation is wrong for angles that wrap around and
for enums: use "previous".

A table with rows of several systems is refused, because values of different vehicles must not be mixed:
select one with `log.select(system=…)` before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.time_base import ClockChoice

Method: TypeAlias = Literal["previous", "linear", "nearest"]
Direction: TypeAlias = Literal["backward", "forward", "nearest"]
_METHODS: Final = ("previous", "linear", "nearest")
_DIRECTIONS: Final = ("backward", "forward", "nearest")
#: Maximum number of rows of a regular time axis, so that a mistyped rate does not fill the memory.
_MAX_ROWS: Final = 1 << 30


@dataclass(frozen=True, slots=True)
class _Ordered:
    """A table in the order of time.

    Attributes:
        name: Name of the table.
        table: Its rows.
        times: Their times in seconds, ascending.
        rows: Row of the table for each time.
    """

    name: str
    table: MessageTable
    times: NDArray[np.float64]
    rows: NDArray[np.intp]


def resample(
    log: Log,
    columns: Sequence[str],
    *,
    rate: float | None = None,
    like: str | None = None,
    method: Method = "previous",
    tolerance: float | None = None,
    scaled: bool = False,
    base: ClockChoice = "auto",
) -> dict[str, NDArray[Any]]:
    """Return columns of several messages at common times.

    Args:
        log: The log.
        columns: Names of the columns, such as `ATTITUDE.roll`.
        rate: Rows per second of a regular time axis, from the first to the last time of the columns' tables.
        like: Name of a table whose times are the axis; either `rate` or `like` is given.
        method: "previous" takes the last value at or before a time, "nearest" the closest one, "linear"
            interpolates.
        tolerance: Maximum distance in seconds to the values that are used; None for any.
        scaled: True gives values in the units of the schema, with NaN for "unknown".
        base: The clock of the times, as in `Log.times`.

    Returns:
        The columns by name, after `_time` with the times in seconds. Numbers are float64 and NaN where there
        is no value; texts are empty there.

    Raises:
        UnknownMessageError: The log has no such table.
        InvalidArgumentError: There is no such column, neither or both of `rate` and `like` are given, a table
            has rows of several systems, or texts are interpolated.
        LogError: The log does not hold that clock.
    """
    if method not in _METHODS:
        raise InvalidArgumentError(f"method must be one of {', '.join(_METHODS)}, got {method!r}")
    if (rate is None) == (like is None):
        raise InvalidArgumentError("either rate or like must be given")
    fields = {column: _split(column) for column in columns}
    tables = {name: _ordered(log, name, base) for name, _ in fields.values()}
    if like is not None:
        axis = _ordered(log, like, base).times
    else:
        axis = _regular_axis([item.times for item in tables.values()], rate or 0.0)
    result: dict[str, NDArray[Any]] = {"_time": axis}
    for column, (name, field) in fields.items():
        values = _values(tables[name].table, field, scaled=scaled)[tables[name].rows]
        result[column] = _sampled(column, values, tables[name].times, axis, method, tolerance)
    return result


def join(
    log: Log,
    left: str,
    *right: str,
    tolerance: float | None = None,
    direction: Direction = "backward",
    scaled: bool = False,
    base: ClockChoice = "auto",
) -> dict[str, NDArray[Any]]:
    """Return the rows of a table, each with the row of other tables that is next to it in time.

    Args:
        log: The log.
        left: Name of the table whose rows are kept.
        right: Names of the tables whose rows are matched.
        tolerance: Maximum distance in seconds between two matched rows; None for any.
        direction: "backward" matches the last row at or before, "forward" the first at or after, "nearest"
            the closest (of two equally close ones the earlier).
        scaled: True gives values in the units of the schema, with NaN for "unknown".
        base: The clock of the times, as in `Log.times`.

    Returns:
        The fields by name (`ATTITUDE.roll`), after `_time` with the times of `left` in seconds. Numbers of
        the matched tables are float64 and NaN without a match; texts are empty there.

    Raises:
        UnknownMessageError: The log has no such table.
        InvalidArgumentError: The direction is unknown, or a table has rows of several systems.
        LogError: The log does not hold that clock.
    """
    if direction not in _DIRECTIONS:
        raise InvalidArgumentError(f"direction must be one of {', '.join(_DIRECTIONS)}, got {direction!r}")
    first = _ordered(log, left, base)
    result: dict[str, NDArray[Any]] = {"_time": first.times}
    for field in _fields(first.table):
        result[f"{left}.{field}"] = _values(first.table, field, scaled=scaled)[first.rows]
    for name in right:
        other = _ordered(log, name, base)
        matches, found = _matches(other.times, first.times, direction, tolerance)
        for field in _fields(other.table):
            values = _values(other.table, field, scaled=scaled)[other.rows]
            result[f"{name}.{field}"] = _taken(values, matches, found)
    return result


def _split(column: str) -> tuple[str, str]:
    name, separator, field = column.partition(".")
    if not separator or not field:
        raise InvalidArgumentError(f"a column is named TABLE.field, such as ATTITUDE.roll, got {column!r}")
    return name, field


def _fields(table: MessageTable) -> list[str]:
    return [name for name in table.dtype.names or () if not name.startswith("_")]


def _ordered(log: Log, name: str, base: ClockChoice) -> _Ordered:
    table = log[name]
    if "_system" in (table.dtype.names or ()) and len(systems := np.unique(table["_system"])) > 1:
        listed = ", ".join(map(str, systems.tolist()))
        raise InvalidArgumentError(f"{name} has rows of systems {listed}: choose one by log.select(system=…)")
    times = log.times_of(name, table, base)
    rows = np.argsort(times, kind="stable")
    rows = rows[: len(rows) - int(np.isnan(times).sum())]  # NaN sorts to the end
    return _Ordered(name, table, times[rows], rows)


def _values(table: MessageTable, field: str, *, scaled: bool) -> NDArray[Any]:
    values: NDArray[Any] = np.asarray(table[table.require_field(field)])
    return table.scaled(field) if scaled and values.dtype.kind in "iuf" else values


def _regular_axis(times: Sequence[NDArray[np.float64]], rate: float) -> NDArray[np.float64]:
    if not (np.isfinite(rate) and rate > 0):
        raise InvalidArgumentError(f"rate must be positive and finite, got {rate}")
    known = [item for item in times if len(item)]
    if not known:
        return np.empty(0)
    first, last = min(item[0] for item in known), max(item[-1] for item in known)
    count = (last - first) * rate + 1
    if count > _MAX_ROWS:
        raise InvalidArgumentError(f"a rate of {rate:g} Hz gives {count:.3g} rows for {last - first:.0f} s")
    # 1e-6 keeps the last row if the product is rounded down.
    axis: NDArray[np.float64] = first + np.arange(int(count + 1e-6)) / rate
    return axis


def _sampled(
    column: str,
    values: NDArray[Any],
    times: NDArray[np.float64],
    axis: NDArray[np.float64],
    method: Method,
    tolerance: float | None,
) -> NDArray[Any]:
    if method != "linear":
        direction: Direction = "backward" if method == "previous" else "nearest"
        return _taken(values, *_matches(times, axis, direction, tolerance))
    if values.dtype.kind not in "iuf" or values.ndim > 1:
        raise InvalidArgumentError(f"{column} cannot be interpolated: it is not one number per row")
    before, found_before = _matches(times, axis, "backward", tolerance)
    after, found_after = _matches(times, axis, "forward", tolerance)
    if not len(times):
        return np.full(len(axis), np.nan)
    numbers = values.astype(np.float64)
    span = times[after] - times[before]
    share = np.divide(axis - times[before], span, out=np.zeros(len(axis)), where=span > 0)
    result = numbers[before] + share * (numbers[after] - numbers[before])
    # Exactly at the time of a row, use its value even if the next value is NaN.
    result = np.where(share == 0, numbers[before], result)
    return np.where(found_before & found_after, result, np.nan)


def _matches(
    times: NDArray[np.float64], wanted: NDArray[np.float64], direction: Direction, tolerance: float | None
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return the position of the match of each wanted time, and whether there is one."""
    if not len(times):
        return np.zeros(len(wanted), np.intp), np.zeros(len(wanted), np.bool_)
    before = np.searchsorted(times, wanted, side="right") - 1
    after = np.searchsorted(times, wanted, side="left")
    last = len(times) - 1
    back, ahead = np.clip(before, 0, last), np.clip(after, 0, last)
    has_back, has_ahead = before >= 0, after <= last
    if direction == "backward":
        chosen, found = back, has_back
    elif direction == "forward":
        chosen, found = ahead, has_ahead
    else:
        is_back = has_back & (~has_ahead | (wanted - times[back] <= times[ahead] - wanted))
        chosen, found = np.where(is_back, back, ahead), has_back | has_ahead
    if tolerance is not None:
        found = found & (np.abs(times[chosen] - wanted) <= tolerance)
    return chosen, found


def _taken(values: NDArray[Any], rows: NDArray[np.intp], found: NDArray[np.bool_]) -> NDArray[Any]:
    """Return the values of rows, NaN or an empty text where no row was found."""
    numbers = values.astype(np.float64) if values.dtype.kind in "iufb" else values
    if not len(numbers):
        shape = (len(rows), *numbers.shape[1:])
        return np.full(shape, np.nan) if numbers.dtype.kind == "f" else np.zeros(shape, numbers.dtype)
    taken = numbers[rows]
    taken[~found] = np.nan if taken.dtype.kind == "f" else b""
    return taken
