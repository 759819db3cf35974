"""Columns of a table in their units, as enum names, and by element."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import NDArray

    from mavstack.logs.schema import EnumSchema, FieldSchema

_ELEMENT: Final = re.compile(r"(?P<field>.+)\[(?P<index>\d+)\]")


def element_of(key: str) -> tuple[str, int] | None:
    """Return the field and the index of an element such as `q[0]`, or None for any other name."""
    found = _ELEMENT.fullmatch(key)
    return None if found is None else (found["field"], int(found["index"]))


def scaled_column(column: NDArray[Any], field: FieldSchema) -> NDArray[np.float64]:
    """Return a column in the unit of its schema.

    Args:
        column: The stored values.
        field: The schema of the column.

    Returns:
        The values as float64; invalid values are NaN.

    Raises:
        InvalidArgumentError: The column holds no numbers.
    """
    if column.dtype.kind not in "iufb":
        raise InvalidArgumentError(f"{field.name} holds no numbers: it is of type {column.dtype}")
    values = column.astype(np.float64)
    if field.multiplier != 1.0:
        values *= field.multiplier
    if field.invalid or field.invalid_by_first is not None:
        values[invalid_values(column, field)] = np.nan
    return values


def invalid_values(column: NDArray[Any], field: FieldSchema) -> NDArray[np.bool_]:
    """Return which values of a column stand for "unknown".

    Args:
        column: The stored values.
        field: The schema of the column.
    """
    markers = field.invalid
    flags = np.zeros(column.shape, np.bool_)
    if len(markers) == 1:
        flags = _equals(column, markers[0])
    elif column.ndim > 1:
        for position, marker in enumerate(markers[: column.shape[1]]):
            flags[:, position] = _equals(column[:, position], marker)
    if field.invalid_by_first is not None and column.ndim > 1:
        flags[_equals(column[:, 0], field.invalid_by_first)] = True
    return flags


def _equals(values: NDArray[Any], marker: float | None) -> NDArray[np.bool_]:
    if marker is None:
        return np.zeros(values.shape, np.bool_)
    if marker != marker:
        return np.isnan(values) if values.dtype.kind == "f" else np.zeros(values.shape, np.bool_)
    equal: NDArray[np.bool_] = np.equal(
        values, values.dtype.type(marker) if values.dtype.kind == "f" else marker
    )
    return equal


def named_column(column: NDArray[Any], enum: EnumSchema) -> NDArray[np.object_]:
    """Return the names of an integer column's values, each made once.

    Args:
        column: The stored values.
        enum: The named values.

    Returns:
        An array of `str` objects in the shape of the column.
    """
    distinct, positions = np.unique(column, return_inverse=True)
    names = np.array([enum.name_of(int(value)) for value in distinct], dtype=object)
    return names[positions.reshape(column.shape)] if len(distinct) else np.empty(column.shape, object)
