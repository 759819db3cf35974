"""The table of a message, and its conversion to data frames of pandas, polars and Arrow.

Data frames have columns of one dimension. An array field therefore becomes a column for each element
(`voltages_0`, `voltages_1` …), or one column of lists.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from mavstack.errors import InvalidArgumentError, MissingExtraError

if TYPE_CHECKING:
    from typing import Any, Literal

    import pandas
    import polars
    import pyarrow

    Arrays = Literal["columns", "lists"]


class MessageTable(np.ndarray[tuple[int], np.dtype[np.void]]):
    """The packets of one message as a numpy structured array: a row per packet, a column per field.

    A column (`table["roll"]`) is a plain numpy array; rows and several columns are a `MessageTable` again.
    """

    if not TYPE_CHECKING:

        def __getitem__(self, key: Any) -> Any:  # noqa: ANN401 (the types of numpy's own method)
            return _plain_column(super().__getitem__(key))

        def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:  # noqa: ANN401
            return _plain_column(super().__array_wrap__(array, context, return_scalar))

    def frame(self, arrays: Arrays = "columns") -> dict[str, np.ndarray[Any, np.dtype[Any]]]:
        """Return the columns by name, as any library for data frames takes them.

        Texts (`char[n]`) are strings; all other values are those of the table.

        Args:
            arrays: "columns" gives a column for each element of an array field (`voltages_0` …), "lists" an
                array of two dimensions.

        Returns:
            Contiguous numpy arrays by column name, in the order of the table.

        Raises:
            InvalidArgumentError: `arrays` is neither "columns" nor "lists".
        """
        if arrays not in ("columns", "lists"):
            raise InvalidArgumentError(f'arrays must be "columns" or "lists", got {arrays!r}')
        names = self.dtype.names or ()
        columns: dict[str, np.ndarray[Any, np.dtype[Any]]] = {}
        for name in names:
            column = np.asarray(self[name])
            if column.ndim > 1 and arrays == "columns":
                for index in range(column.shape[1]):
                    element = f"{name}_{index}"
                    # The definition may have a field of that name.
                    columns[element if element not in names else f"{name}[{index}]"] = _flat(column[:, index])
            else:
                columns[name] = _flat(column)
        return columns

    def to_pandas(self, arrays: Arrays = "columns") -> pandas.DataFrame:
        """Return the table as a pandas `DataFrame`; `_time` is in UTC.

        Args:
            arrays: "columns" gives a column for each element of an array field, "lists" a column of lists.

        Returns:
            The data frame, with a copy of the data.

        Raises:
            InvalidArgumentError: `arrays` is neither "columns" nor "lists".
            MissingExtraError: pandas is not installed.
        """
        columns: dict[str, Any] = dict(self.frame(arrays))
        pd = _module("pandas", "to_pandas()", "pandas")
        for name, column in columns.items():
            if column.ndim > 1:
                columns[name] = pd.Series(column.tolist(), dtype=object)
            elif column.dtype.kind == "M":
                columns[name] = pd.Series(column).dt.tz_localize("UTC")
        frame: pandas.DataFrame = pd.DataFrame(columns)
        return frame

    def to_polars(self, arrays: Arrays = "columns") -> polars.DataFrame:
        """Return the table as a polars `DataFrame`; `_time` is in UTC, and null where it is not recorded.

        Args:
            arrays: "columns" gives a column for each element of an array field, "lists" a column of the type
                `Array`.

        Returns:
            The data frame.

        Raises:
            InvalidArgumentError: `arrays` is neither "columns" nor "lists".
            MissingExtraError: polars is not installed.
        """
        columns = self.frame(arrays)
        pl = _module("polars", "to_polars()", "polars")
        frame = pl.DataFrame([pl.Series(name, column) for name, column in columns.items()])
        times = [name for name, column in columns.items() if column.dtype.kind == "M"]
        result: polars.DataFrame = frame.with_columns(
            pl.col(name).dt.replace_time_zone("UTC") for name in times
        )
        return result

    def to_arrow(self, arrays: Arrays = "columns") -> pyarrow.Table:
        """Return the table as an Arrow `Table`; `_time` is in UTC, and null where it is not recorded.

        Args:
            arrays: "columns" gives a column for each element of an array field, "lists" a column of lists of
                fixed size.

        Returns:
            The table, with a copy of the data.

        Raises:
            InvalidArgumentError: `arrays` is neither "columns" nor "lists".
            MissingExtraError: pyarrow is not installed.
        """
        columns = self.frame(arrays)
        pa = _module("pyarrow", "to_arrow()", "arrow")
        converted = {}
        for name, column in columns.items():
            if column.ndim > 1:
                converted[name] = pa.FixedSizeListArray.from_arrays(pa.array(column.ravel()), column.shape[1])
            elif column.dtype.kind == "M":
                converted[name] = pa.array(column).cast(pa.timestamp("us", tz="UTC"))
            else:
                converted[name] = pa.array(column)
        table: pyarrow.Table = pa.table(converted)
        return table


def _plain_column(value: Any) -> Any:  # noqa: ANN401 (the types of numpy's own method)
    """Return an array without fields as a plain numpy array."""
    if isinstance(value, MessageTable) and value.dtype.names is None:
        return value.view(np.ndarray)
    return value


def _flat(column: np.ndarray[Any, np.dtype[Any]]) -> np.ndarray[Any, np.dtype[Any]]:
    if column.dtype.kind == "S":
        return np.char.decode(column, "utf-8", "replace")
    return np.ascontiguousarray(column)


def _module(name: str, method: str, extra: str) -> Any:  # noqa: ANN401 (optional, without types)
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(method, extra) from None
