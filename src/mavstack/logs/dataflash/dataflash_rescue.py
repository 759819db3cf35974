"""Rescue of binary DataFlash logs: the records that the index accepts, byte for byte.

The result is a file that strict readers read to its end: records of types without a definition, definitions
that make no sense, and the records of such types are left out. The format has no checksums, so a record in
the middle of which bytes were overwritten stays.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.dataflash.dataflash_log import DataFlashLog
from mavstack.logs.dataflash.record_type import RecordType, is_readable
from mavstack.logs.rescue import Rescue

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray

    from mavstack.logs.log_bytes import LogBytes

_WINDOW: Final = 8 << 20
_FMT: Final = "FMT"
_FMT_TYPE: Final = 128
_FMT_FORMAT: Final = "BBnNZ"
_CHECKED: Final = (_FMT, "FMTU", "UNIT", "MULT")
#: Position of the id character in a UNIT or MULT record.
_ID: Final = 11
#: Format characters of fields that may number the instances of a sensor.
_INSTANCES: Final = "bBhHiIqQnN"


class DataFlashRescue(Rescue):
    """Finds the records of a binary DataFlash log."""

    def __init__(self, data: LogBytes) -> None:
        super().__init__(data)
        self._log = DataFlashLog(data)
        self._left_out = 0
        #: The undamaged format definitions so far, by type number.
        self._types: dict[int, RecordType] = {}

    def pieces(self, progress: Callable[[int, int], None]) -> Iterator[bytes]:
        """Yield the records; see `Rescue.pieces`."""
        definitions = self._log.definitions
        for positions in self._log.record_positions(_WINDOW):
            sound = {
                name: rows
                for name, rows in positions.items()
                if definitions[name].name == _FMT or is_readable(definitions[name])
            }
            yield self._content(sound, definitions)
            self._left_out += sum(len(rows) for name, rows in positions.items() if name not in sound)
            progress(int(max(rows[-1] for rows in positions.values())), self.data.size)
        progress(self.data.size, self.data.size)
        skipped = self._log.skipped
        if self._left_out:
            other = {**skipped.other, "records that other readers cannot read": self._left_out}
            skipped = replace(skipped, other=other)
        self.damage = skipped

    def _content(
        self, positions: Mapping[str, NDArray[np.int64]], definitions: Mapping[str, RecordType]
    ) -> bytes:
        """Return records in the order of the file."""
        if not positions:
            return b""
        starts = np.concatenate(list(positions.values()))
        ends = np.concatenate([rows + definitions[name].length for name, rows in positions.items()])
        order = np.argsort(starts)
        starts, ends = starts[order], ends[order]
        first = int(starts[0])
        data = self.data.read(first, int(ends[-1]) - first)
        bad = {
            int(position)
            for name, rows in positions.items()
            if definitions[name].name in _CHECKED
            for position in rows
            if not self._is_sound(
                definitions[name].name, data[position - first : position - first + definitions[name].length]
            )
        }
        if bad:
            kept = ~np.isin(starts, list(bad))
            starts, ends = starts[kept], ends[kept]
            self._left_out += len(bad)
        self.records += len(starts)
        return b"".join(data[start - first : end - first] for start, end in _ranges(starts, ends))

    def _is_sound(self, name: str, record: bytes) -> bool:
        """Return whether other readers can use a definition or the names of units."""
        if name == _FMT:
            texts = _text(record[5:9]), _text(record[9:25]), _text(record[25:89])
            kind = RecordType.of(*texts, record[4])
            sound = is_readable(kind) and (record[3] != _FMT_TYPE or kind.format == _FMT_FORMAT)
            if sound:
                self._types[record[3]] = kind
            return sound
        if name == "FMTU":
            return self._are_sound_units(record[_ID], _text(record[12:28]), _text(record[28:44]))
        return len(record) > _ID and record[_ID] < 128

    def _are_sound_units(self, number: int, units: bytes, multipliers: bytes) -> bool:
        """Return whether each unit has a multiplier, and the marked instance can be a number."""
        kind, instance = self._types.get(number), units.find(b"#")
        if len(multipliers) < len(units) or kind is None or instance < 0:
            return len(multipliers) >= len(units)
        return instance < len(kind.format) and kind.format[instance] in _INSTANCES


def _ranges(starts: NDArray[np.int64], ends: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    """Yield the ranges of records that follow each other directly."""
    if not len(starts):
        return
    breaks = np.flatnonzero(starts[1:] != ends[:-1])
    firsts = starts[np.concatenate([[0], breaks + 1])]
    lasts = ends[np.concatenate([breaks, [len(ends) - 1]])]
    yield from zip(firsts.tolist(), lasts.tolist(), strict=True)


def _text(field: bytes) -> bytes:
    return field.partition(b"\0")[0]
