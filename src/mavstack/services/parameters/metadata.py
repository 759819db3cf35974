"""The metadata of parameters: description, unit, range, named values, bits, effect after a reboot only.

The firmware's developers publish it; the parameter protocol does not carry it. `ParameterMetadata` holds the
facts of one parameter in one form, whichever file they come from, and `MetadataTable` those of a firmware.

A name may be a template: `RC{n}_MIN` describes RC1_MIN, RC2_MIN and so on, with the number in the place of
`{n}` in its texts (guide: component metadata, parameter.schema.json).

The range of a parameter is advice of the developers, not a limit of the vehicle: PX4 and ArduPilot accept
values outside of most ranges. A parameter with a range and named values allows both. Named values with a
fraction are examples, so they restrict nothing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf, isfinite
from struct import pack, unpack
from typing import TYPE_CHECKING, Final

from mavstack.services.frames import as_float32
from mavstack.services.parameters.value import shortest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.services.parameters.value import Value

#: The placeholder for a number in the name of a template.
_TEMPLATE_MARK: Final = "{n}"
#: The number of bits of a parameter.
BITS: Final = 32
#: The largest number of named values that an error lists.
_LISTED_VALUES: Final = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterMetadata:
    """The metadata of one parameter; a fact that the developers do not state is None or empty.

    Attributes:
        name: The name of the parameter.
        short_description: A few words, such as "Return altitude".
        long_description: The whole description.
        unit: The unit of the value, as the developers write it: "m", "cm/s", "deg".
        minimum: The smallest value of the range.
        maximum: The largest value of the range.
        default: The value of a new vehicle.
        increment: The step in which a user interface changes the value.
        decimal_places: The decimals that a user interface shows.
        values: The names of values, by value.
        bitmask: The names of bits, by the number of the bit; empty if the value is not a bitmask.
        reboot_required: True if a new value takes effect after a reboot only.
        read_only: True if the parameter cannot be set.
        volatile: True if the vehicle itself changes the value.
        group: The group of related parameters.
        category: The audience, such as "Standard" or "Developer".
        type: The type of the value as a MAV_PARAM_TYPE.
    """

    name: str
    short_description: str = ""
    long_description: str = ""
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    default: float | None = None
    increment: float | None = None
    decimal_places: int | None = None
    values: Mapping[Value, str] = field(default_factory=dict, hash=False)
    bitmask: Mapping[int, str] = field(default_factory=dict, hash=False)
    reboot_required: bool = False
    read_only: bool = False
    volatile: bool = False
    group: str = ""
    category: str = ""
    type: int | None = None

    @property
    def has_range(self) -> bool:
        """True if a smallest or a largest value is stated."""
        return self.minimum is not None or self.maximum is not None

    @property
    def has_only_values(self) -> bool:
        """True if the value must be one of `values`."""
        return bool(self.values) and not self.has_range and all(value == int(value) for value in self.values)

    def problem(self, value: Value) -> str | None:
        """Return why the metadata does not allow a value.

        Args:
            value: The value, in the parameter's own unit.

        Returns:
            The reason in words, such as "5000 is outside of its range 0 to 150 m"; None if it is allowed.
        """
        if self.read_only:
            return "it is read-only"
        if not (self.has_range or self.has_only_values or self.bitmask):
            return None
        if value in self.values or value == self.default:
            return None
        if not isfinite(value):
            return f"{number_text(value)} is not a finite number"
        if self.bitmask:
            return self._problem_of_bits(value)
        if self.has_range:
            outside = f"{number_text(value)} is outside of its range {self.range_text}"
            return None if self._is_in_range(value) else outside
        return f"{number_text(value)} is not one of its values {self._listed_values()}"

    @property
    def range_text(self) -> str:
        """The range in words with the unit: "0 to 150 m", "at least 0"; empty if none is stated."""
        unit = f" {self.unit}" if self.unit else ""
        if self.minimum is None:
            return "" if self.maximum is None else f"at most {number_text(self.maximum)}{unit}"
        if self.maximum is None:
            return f"at least {number_text(self.minimum)}{unit}"
        return f"{number_text(self.minimum)} to {number_text(self.maximum)}{unit}"

    def describe(self, value: Value) -> str:
        """Return the names of a value: that of the value itself, or those of its bits.

        Args:
            value: The value.

        Returns:
            The names; empty if the metadata has none for it.
        """
        if value in self.values:
            return self.values[value]
        if not self.bitmask or not isfinite(value) or value != int(value):
            return ""
        return ", ".join(name for bit, name in sorted(self.bitmask.items()) if int(value) >> bit & 1)

    def _problem_of_bits(self, value: Value) -> str | None:
        if value != int(value):
            return f"{number_text(value)} is not a whole number, which a bitmask must be"
        bits = [bit for bit in range(BITS) if int(value) >> bit & 1]
        unknown = [bit for bit in bits if bit not in self.bitmask]
        if not unknown or (self.has_range and self._is_in_range(value)):
            return None
        known = ", ".join(map(str, sorted(self.bitmask)))
        return f"{number_text(value)} sets bit {unknown[0]}, which is not one of its bits {known}"

    def _is_in_range(self, value: Value) -> bool:
        """Return whether a value is in the range, exactly or as the float32 that a vehicle stores."""
        low = -inf if self.minimum is None else self.minimum
        high = inf if self.maximum is None else self.maximum
        return low <= value <= high or _single(low) <= _single(value) <= _single(high)

    def _listed_values(self) -> str:
        names = [f"{number_text(value)} ({name})" for value, name in self.values.items()]
        more = len(names) - _LISTED_VALUES
        return ", ".join(names[:_LISTED_VALUES]) + (f" and {more} more" if more > 0 else "")


class MetadataTable(Mapping[str, ParameterMetadata]):
    """The metadata of a firmware's parameters, by name; a name finds the template that it matches too.

    Iteration and length leave templates out, since they name no parameter.

    Args:
        entries: The metadata of each parameter or template; of several for one name the last counts.
        source: Where the metadata comes from, for people: a file, a URI.
    """

    def __init__(self, entries: Iterable[ParameterMetadata] = (), source: str = "") -> None:
        self.source = source
        found = {entry.name: entry for entry in entries}
        self._entries = {name: entry for name, entry in found.items() if _TEMPLATE_MARK not in name}
        self._templates = [
            (_template_pattern(name), entry) for name, entry in found.items() if _TEMPLATE_MARK in name
        ]

    def __getitem__(self, name: str) -> ParameterMetadata:
        found = self._entries.get(name)
        if found is not None:
            return found
        for pattern, entry in self._templates:
            number = pattern.fullmatch(name)
            if number is not None:
                return _filled(entry, name, number[1])
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __bool__(self) -> bool:
        return bool(self._entries or self._templates)

    def problem(self, name: str, value: Value) -> str | None:
        """Return why the metadata of a parameter does not allow a value.

        Args:
            name: The name of the parameter.
            value: The value, in the parameter's own unit.

        Returns:
            The reason in words; None if the value is allowed, or nothing is known of the parameter.
        """
        found = self.get(name)
        return None if found is None else found.problem(value)

    def __repr__(self) -> str:
        return f"<MetadataTable of {len(self) + len(self._templates)} parameters from {self.source!r}>"


#: The table of a component without known metadata.
NO_METADATA: Final = MetadataTable(source="none")


def number_text(value: Value) -> str:
    """Return a number without a needless fraction or needless digits."""
    if isinstance(value, int) or not isfinite(value):
        return str(value)
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else shortest(value)


def _single(value: float) -> float:
    """Return the nearest float32."""
    return float(unpack("<f", pack("<f", as_float32(value)))[0])


def _template_pattern(name: str) -> re.Pattern[str]:
    head, _, tail = name.partition(_TEMPLATE_MARK)
    numbers = r"(\d{1,3})"
    return re.compile(re.escape(head) + numbers + re.escape(tail).replace(re.escape(_TEMPLATE_MARK), r"\1"))


def _filled(entry: ParameterMetadata, name: str, number: str) -> ParameterMetadata:
    """Return the metadata of one parameter of a template."""
    return replace(
        entry,
        name=name,
        short_description=entry.short_description.replace(_TEMPLATE_MARK, number),
        long_description=entry.long_description.replace(_TEMPLATE_MARK, number),
    )
