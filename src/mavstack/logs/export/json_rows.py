"""Rows of a table as JSON objects, made column by column by Arrow instead of row by row.

Numbers have the fewest digits from which a double is read back exactly; a number that is not finite is null.
"""

from __future__ import annotations

import json
from functools import cache
from importlib import import_module
from itertools import chain
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    #: A pyarrow array of strings; pyarrow has no type hints.
    Texts = Any

#: Kinds of columns with texts, which often repeat: each different text is converted once.
_TEXT_KINDS: Final = "SU"


def json_rows(columns: Mapping[str, NDArray[Any] | Texts]) -> Texts:
    """Return a JSON object for each row.

    Args:
        columns: At least one column by name, all of one length; a column of arrays has more dimensions. One
            that is a pyarrow array holds JSON already.

    Returns:
        A pyarrow array of strings.
    """
    keys = [json.dumps(name) for name in columns]
    openings = [f"{'{' if number == 0 else ', '}{key}: " for number, key in enumerate(keys)]
    texts = [json_values(each) if isinstance(each, np.ndarray) else each for each in columns.values()]
    return joined([*chain.from_iterable(zip(openings, texts, strict=True)), "}"])


def joined(pieces: Iterable[str | Texts]) -> Texts:
    """Return the concatenation of arrays of strings and of texts that are the same in each row."""
    return _compute().binary_join_element_wise(*pieces, "")


def json_values(column: NDArray[Any]) -> Texts:
    """Return the JSON of each value of a column; the values of a column of arrays are lists."""
    texts = _single_values(np.ascontiguousarray(column).reshape(-1))
    for length in reversed(column.shape[1:]):
        texts = _lists(texts, length)
    return texts


def _lists(texts: Texts, length: int) -> Texts:
    """Return a JSON list for each `length` texts."""
    arrow = import_module("pyarrow")
    ends = arrow.array(np.arange(0, len(texts) + 1, length, dtype=np.int32))
    return joined(["[", _compute().binary_join(arrow.ListArray.from_arrays(ends, texts), ", "), "]"])


def _single_values(values: NDArray[Any]) -> Texts:
    arrow, compute = import_module("pyarrow"), _compute()
    kind = values.dtype.kind
    if kind in "iub":
        return compute.cast(arrow.array(values), arrow.string())
    if kind == "f":
        texts = compute.cast(arrow.array(values.astype(np.float64)), arrow.string())
        finite = np.isfinite(values)
        return texts if finite.all() else compute.if_else(arrow.array(finite), texts, "null")
    if kind in _TEXT_KINDS:
        distinct, numbers = np.unique(values, return_inverse=True)
        return arrow.array([_text(value) for value in distinct.tolist()], arrow.string()).take(
            arrow.array(numbers.reshape(-1))
        )
    known = cache(json.dumps)
    return arrow.array([known(value) for value in values.tolist()], arrow.string())


def _text(value: str | bytes) -> str:
    return json.dumps(value.decode("utf-8", "replace") if isinstance(value, bytes) else value)


def _compute() -> Any:  # noqa: ANN401 (pyarrow has no types)
    return import_module("pyarrow.compute")
