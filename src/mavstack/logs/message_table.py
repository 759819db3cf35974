"""The table of a message, and its conversion to data frames of pandas, polars and Arrow.

Data frames have columns of one dimension. An array field therefore becomes a column for each element
(`voltages_0`, `voltages_1` …), or one column of lists.
"""

from __future__ import annotations

import json
from importlib import import_module
from typing import TYPE_CHECKING, cast

import numpy as np

from mavstack.errors import InvalidArgumentError, MissingExtraError
from mavstack.logs.columns import element_of, named_column, scaled_column
from mavstack.logs.schema import schema_of_dtype
from mavstack.logs.table_text import suggestion, table_text

if TYPE_CHECKING:
    from typing import Any, Literal

    import pandas
    import polars
    import pyarrow

    from mavstack.logs.schema import FieldSchema, SchemaSource, TableSchema

    Arrays = Literal["columns", "lists"]


class MessageTable(np.ndarray[tuple[int], np.dtype[np.void]]):
    """The records of one name as a numpy structured array: a row per record, a column per field.

    A column (`table["roll"]`) is a plain numpy array, a view without a copy; `table["q[0]"]` is one element
    of an array field. Rows and several columns are a `MessageTable` again, with the same schema.
    """

    _source: SchemaSource | None = None

    if not TYPE_CHECKING:

        def __getitem__(self, key: Any) -> Any:  # noqa: ANN401 (the types of numpy's own method)
            if isinstance(key, str):
                if key in (self.dtype.fields or ()):
                    return self.view(np.ndarray)[key]
                return self._element(*(element_of(key) or self._field(key)))
            return _plain_column(super().__getitem__(key))

        def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:  # noqa: ANN401
            return _plain_column(super().__array_wrap__(array, context, return_scalar))

    def __str__(self) -> str:
        if not self.dtype.names or self.ndim != 1:
            return super().__str__()
        schema = self.schema
        columns = {name: self[name] for name in self.dtype.names}
        return table_text(schema.name, columns, {name: _stored_unit(schema[name]) for name in columns})

    def __array_finalize__(self, parent: object) -> None:
        self._source = getattr(parent, "_source", None)

    def __reduce__(self) -> tuple[Any, ...]:
        make, arguments, state = cast("tuple[Any, ...]", super().__reduce__())[:3]
        return make, arguments, (state, self._source)

    def __setstate__(self, state: Any) -> None:  # noqa: ANN401 (numpy's own state inside)
        super().__setstate__(state[0])
        self._source = state[1]

    @classmethod
    def of(cls, rows: np.ndarray[Any, np.dtype[np.void]], source: SchemaSource | None = None) -> MessageTable:
        """Return a structured array as a table, without a copy.

        Args:
            rows: The structured array.
            source: Its schema; None takes the types alone.
        """
        table = rows.view(cls)
        if source is not None:
            table._source = source  # noqa: SLF001 (of this class)
        return table

    def where(self, rows: np.ndarray[Any, np.dtype[np.bool_]]) -> MessageTable:
        """Return some rows as a table: `table[rows]`, with its type known to type checkers.

        Args:
            rows: True for each row to keep.
        """
        return MessageTable.of(np.asarray(self)[rows], self._source)

    @property
    def schema(self) -> TableSchema:
        """The meaning of the columns: units, multipliers, enums, descriptions."""
        names = self.dtype.names or ()
        if self._source is None:
            return schema_of_dtype("", self.dtype)
        schema = self._source.schema
        return schema if names == schema.names else schema.restricted_to(names)

    def scaled(self, field: str) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Return a column in the unit of its schema.

        Args:
            field: Name of the column, or of an element such as `q[0]`.

        Returns:
            The values times the multiplier, as float64; values that the definition marks as invalid are NaN.

        Raises:
            InvalidArgumentError: The table has no such column, or it holds no numbers.
        """
        name, index = self._field(field)
        values = scaled_column(self[name], self.schema[name])
        return values if index is None else values[:, index]

    def enum_names(self, field: str) -> np.ndarray[Any, np.dtype[np.object_]]:
        """Return a column as the names of its values.

        Args:
            field: Name of the column, or of an element such as `q[0]`.

        Returns:
            An array of `str`, such as "QUADROTOR"; flags are joined by `|`, and a value without a name is its
            number.

        Raises:
            InvalidArgumentError: The table has no such column, or its values have no names.
        """
        enum = self.schema[self._field(field)[0]].enum
        if enum is None:
            raise InvalidArgumentError(f"the values of {field} have no names")
        return named_column(self[field], enum)

    def require_field(self, field: str) -> str:
        """Return the name of a column, or of an element such as `q[0]`, that the table has.

        Args:
            field: The name.

        Raises:
            InvalidArgumentError: The table has no such column.
        """
        self._field(field)
        return field

    def has_number(self, field: str) -> bool:
        """Return whether the table has a column, or an element such as `q[0]`, with one number in each row.

        Args:
            field: The name.
        """
        names = self.dtype.names or ()
        if field in names:
            return not self.dtype[field].shape and self.dtype[field].kind in "iufb"
        name, index = element_of(field) or (field, 0)
        if name not in names or not self.dtype[name].shape:
            return False
        return index < self.dtype[name].shape[0] and self.dtype[name].base.kind in "iufb"

    def _field(self, field: str) -> tuple[str, int | None]:
        """Return the name of a column and the index of an element."""
        names = self.dtype.names or ()
        if field in names:
            return field, None
        name, index = element_of(field) or (field, 0)
        if name not in names or index >= (self.dtype[name].shape or (0,))[0]:
            label = self.schema.name or "the table"
            close = suggestion(field, names)
            raise InvalidArgumentError(f"{label} has no field {field}{close}; it has {', '.join(names)}")
        return name, index

    def _element(self, name: str, index: int) -> np.ndarray[Any, np.dtype[Any]]:
        return np.asarray(self[self._field(f"{name}[{index}]")[0]])[:, index]

    def frame(
        self, arrays: Arrays = "columns", *, scaled: bool = False, enums: bool = False
    ) -> dict[str, np.ndarray[Any, np.dtype[Any]]]:
        """Return the columns by name, as any library for data frames takes them.

        Texts (`char[n]`) are strings; all other values are those of the table, unless `scaled` or `enums` say
        otherwise.

        Args:
            arrays: "columns" gives a column for each element of an array field (`voltages_0` …), "lists" an
                array of two dimensions.
            scaled: True gives numbers in the units of the schema, as float64 with NaN for "unknown".
            enums: True gives the names of enum values.

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
            column = self._values(name, scaled=scaled, enums=enums)
            if column.ndim > 1 and arrays == "columns":
                for index in range(column.shape[1]):
                    columns[self._element_name(name, index)] = _flat(column[:, index])
            else:
                columns[name] = _flat(column)
        return columns

    def _values(self, name: str, *, scaled: bool, enums: bool) -> np.ndarray[Any, np.dtype[Any]]:
        column = np.asarray(self[name])
        if name.startswith("_") or not (scaled or enums):
            return column
        if enums and self.schema[name].enum is not None:
            return self.enum_names(name)
        return self.scaled(name) if scaled and column.dtype.kind in "iuf" else column

    def _element_name(self, name: str, index: int) -> str:
        """Return the name of the column of an element; the definition may have a field of that name."""
        element = f"{name}_{index}"
        return element if element not in (self.dtype.names or ()) else f"{name}[{index}]"

    def to_pandas(
        self, arrays: Arrays = "columns", *, scaled: bool = False, enums: bool = False
    ) -> pandas.DataFrame:
        """Return the table as a pandas `DataFrame`; `_time` is in UTC.

        Args:
            arrays: "columns" gives a column for each element of an array field, "lists" a column of lists.
            scaled: True gives numbers in the units of the schema, as float64 with NaN for "unknown".
            enums: True gives the names of enum values.

        Returns:
            The data frame, with a copy of the data.

        Raises:
            InvalidArgumentError: `arrays` is neither "columns" nor "lists".
            MissingExtraError: pandas is not installed.
        """
        columns: dict[str, Any] = dict(self.frame(arrays, scaled=scaled, enums=enums))
        pd = _module("pandas", "to_pandas()", "pandas")
        for name, column in columns.items():
            if column.ndim > 1:
                columns[name] = pd.Series(column.tolist(), dtype=object)
            elif column.dtype.kind == "M":
                columns[name] = pd.Series(column).dt.tz_localize("UTC")
        frame: pandas.DataFrame = pd.DataFrame(columns, copy=False)
        return frame

    def to_polars(
        self, arrays: Arrays = "columns", *, scaled: bool = False, enums: bool = False
    ) -> polars.DataFrame:
        """Return the table as a polars `DataFrame`; `_time` is in UTC, and null where it is not recorded.

        Args:
            arrays: "columns" gives a column for each element of an array field, "lists" a column of the type
                `Array`.
            scaled: True gives numbers in the units of the schema, as float64 with NaN for "unknown".
            enums: True gives the names of enum values.

        Returns:
            The data frame.

        Raises:
            InvalidArgumentError: `arrays` is neither "columns" nor "lists".
            MissingExtraError: polars is not installed.
        """
        columns = self.frame(arrays, scaled=scaled, enums=enums)
        pl = _module("polars", "to_polars()", "polars")
        frame = pl.DataFrame([pl.Series(name, column) for name, column in columns.items()])
        times = [name for name, column in columns.items() if column.dtype.kind == "M"]
        result: polars.DataFrame = frame.with_columns(
            pl.col(name).dt.replace_time_zone("UTC") for name in times
        )
        return result

    def to_arrow(
        self, arrays: Arrays = "columns", *, scaled: bool = False, enums: bool = False
    ) -> pyarrow.Table:
        """Return the table as an Arrow `Table`; `_time` is in UTC, and null where it is not recorded.

        Args:
            arrays: "columns" gives a column for each element of an array field, "lists" a column of lists of
                fixed size.
            scaled: True gives numbers in the units of the schema, as float64 with NaN for "unknown".
            enums: True gives the names of enum values.

        Returns:
            The table, with a copy of the data.

        Raises:
            InvalidArgumentError: `arrays` is neither "columns" nor "lists".
            MissingExtraError: pyarrow is not installed.
        """
        columns = self.frame(arrays, scaled=scaled, enums=enums)
        pa = _module("pyarrow", "to_arrow()", "arrow")
        converted = [_arrow_column(pa, column) for column in columns.values()]
        metadata = self._arrow_metadata(scaled=scaled)
        fields = [
            pa.field(name, column.type, metadata=metadata.get(name))
            for name, column in zip(columns, converted, strict=True)
        ]
        description = {"mavstack.table": json.dumps(self.schema.to_dict())}
        table: pyarrow.Table = pa.table(converted, schema=pa.schema(fields, metadata=description))
        return table

    def _arrow_metadata(self, *, scaled: bool) -> dict[str, dict[str, str]]:
        """Return the unit, the multiplier, the enum and the description of each column as texts."""
        found: dict[str, dict[str, str]] = {}
        for field in self.schema:
            values = field.to_dict()
            texts: dict[str, str] = {
                key: str(values[key]) for key in ("unit", "enum", "description") if key in values
            }
            if "multiplier" in values and not scaled:
                texts["multiplier"] = str(values["multiplier"])
            names = [self._element_name(field.name, index) for index in range(field.array_length)]
            found |= dict.fromkeys((field.name, *names), texts)
        return found


def _stored_unit(field: FieldSchema) -> str:
    """Return the unit of the values as they are stored, such as `1e-06 s`; empty if it is not known."""
    return f"{field.multiplier:g} {field.unit}" if field.unit and field.multiplier != 1 else field.unit


def _plain_column(value: Any) -> Any:  # noqa: ANN401 (the types of numpy's own method)
    """Return an array without fields as a plain numpy array."""
    if isinstance(value, MessageTable) and value.dtype.names is None:
        return value.view(np.ndarray)
    return value


def _flat(column: np.ndarray[Any, np.dtype[Any]]) -> np.ndarray[Any, np.dtype[Any]]:
    if column.dtype.kind == "S":
        return np.char.decode(column, "utf-8", "replace")
    return np.ascontiguousarray(column)


def _arrow_column(pa: Any, column: np.ndarray[Any, np.dtype[Any]]) -> Any:  # noqa: ANN401 (optional, without types)
    if column.ndim > 1:
        return pa.FixedSizeListArray.from_arrays(_arrow_column(pa, column.ravel()), column.shape[1])
    if column.dtype.kind == "M":
        return pa.array(column).cast(pa.timestamp("us", tz="UTC"))
    return pa.array(column, pa.string()) if column.dtype.kind in "OU" else pa.array(column)


def _module(name: str, method: str, extra: str) -> Any:  # noqa: ANN401 (optional, without types)
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(method, extra) from None
