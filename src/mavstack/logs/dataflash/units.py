"""Units of the fields, from three record types of the log.

UNIT and MULT give a unit or a factor to a character; FMTU gives each field of a type number one character of
both. The character "#" marks the field with the number of the sensor.
"""

from __future__ import annotations

from bisect import bisect_left
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.logs.dataflash.record_type import Units

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    Table = NDArray[Any]

_INSTANCE: Final = "#"


def has_units(fmtu: Table | None) -> bool:
    """Return whether the table FMTU has the columns that the firmware gives it.

    Args:
        fmtu: The table, or None.
    """
    columns = {"FmtType": "iu", "UnitIds": "S", "MultIds": "S"}
    return fmtu is not None and all(_is_kind(fmtu, name, kinds) for name, kinds in columns.items())


def _is_kind(table: Table, name: str, kinds: str) -> bool:
    """Return whether a table has a column with a single value in each row, of certain kinds of types."""
    return name in (table.dtype.names or ()) and table.dtype[name].kind in kinds


class SlotFinder:
    """Finds the definition that a type number had at some place of the log.

    Args:
        redefinitions: (position, type number, slot) in file order.
    """

    def __init__(self, redefinitions: Sequence[tuple[int, int, int]]) -> None:
        self._by_type: dict[int, tuple[list[int], list[int]]] = {}
        for position, number, slot in redefinitions:
            positions, slots = self._by_type.setdefault(number, ([], []))
            positions.append(position)
            slots.append(slot)

    def slot(self, number: int, position: int) -> int | None:
        """Return the slot of a type number: the definition before `position`, or else the first after it.

        Args:
            number: The type number.
            position: Position in the file.
        """
        known = self._by_type.get(number)
        if known is None:
            return 0 if number == _FMT_TYPE else None
        positions, slots = known
        return slots[max(bisect_left(positions, position) - 1, 0)]


_FMT_TYPE: Final = 0x80


def units_by_slot(
    fmtu: Mapping[int, Table], unit: Table | None, mult: Table | None, slot: Callable[[int, int], int | None]
) -> dict[int, Units]:
    """Return the units of each definition.

    Args:
        fmtu: The records of FMTU by position in the file.
        unit: The table UNIT.
        mult: The table MULT.
        slot: Returns the slot of a type number at a position.
    """
    units, factors = _characters(unit, "Label", "S"), _characters(mult, "Mult", "iuf")
    found = {}
    for position, record in fmtu.items():
        number = slot(int(record["FmtType"]), position)
        if number is not None:
            found[number] = _units(_text(record["UnitIds"]), _text(record["MultIds"]), units, factors)
    return found


def _units(unit_ids: str, factor_ids: str, units: Mapping[str, Any], factors: Mapping[str, Any]) -> Units:
    """Return the units of a definition from the characters of FMTU."""
    return Units(
        {index: _text(units[name]) for index, name in enumerate(unit_ids) if name in units},
        {index: _factor(factors[name]) for index, name in enumerate(factor_ids) if name in factors},
        unit_ids.index(_INSTANCE) if _INSTANCE in unit_ids else None,
    )


def _characters(table: Table | None, column: str, kinds: str) -> dict[str, Any]:
    """Return the values of UNIT or MULT by character."""
    if table is None or not _is_kind(table, "Id", "iu") or not _is_kind(table, column, kinds):
        return {}
    return {chr(int(row["Id"]) & 0xFF): row[column] for row in table}


def _text(value: Any) -> str:  # noqa: ANN401 (an element of a table)
    return bytes(value).decode("latin-1")


def _factor(value: float) -> float:
    """Return a factor, which the firmware rounds to single precision before it writes a double."""
    factor = float(f"{float(value):.7g}")
    return factor if np.isfinite(factor) else 0.0
