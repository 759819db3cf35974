"""Enum classes, created on first use: `IntEnum`, and `IntFlag` for bitmasks.

A value without a member reads as a plain integer in an `IntEnum` field. A bitmask always reads as its
`IntFlag`. Python's `enum` keeps every combination of flags it ever created, so a stream of random masks could
fill the memory; `_missing_` here creates combinations without keeping them.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum, IntFlag
from functools import lru_cache

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from typing import Any, Protocol, TypeAlias

    from mavstack.dialects.dialect import Dialect
    from mavstack.dialects.model import EnumDefinition

    class EnumFiles(Protocol):
        """The part of a dialect that its mapping of enums uses."""

        @property
        def enum_files(self) -> Mapping[str, object]:
            """The files of each enum by name."""

        def enum_class(self, name: str) -> EnumClass:
            """Return the class of an enum."""


#: Last characters of format specifications for numbers.
_NUMBER_FORMATS = frozenset("bcdeEfFgGnoxX%")
#: Maximum number of cached combinations of flags per bitmask.
MAX_CACHED_COMBINATIONS = 256

EnumClass: TypeAlias = "type[MavEnum | MavFlag]"
#: Members by value, and a function for values that have no member.
EnumReader: TypeAlias = "tuple[dict[int, int], Callable[[int], int] | None]"


class MavEnum(IntEnum):
    """Base of the enum classes. A member is an integer, and its text is its name."""

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        return int.__format__(self, spec) if spec and spec[-1] in _NUMBER_FORMATS else format(str(self), spec)

    @classmethod
    def definition(cls) -> EnumDefinition:
        """Return the definition of the enum, with the entries of all files.

        Returns:
            The definition, with descriptions and command parameters.
        """
        return definition_of(cls)

    @property
    def official_name(self) -> str:
        """Name in the definition, such as `MAV_CMD_NAV_TAKEOFF`."""
        return official_names(type(self))[self.value]

    def __reduce_ex__(self, _protocol: object) -> tuple[Any, ...]:
        return restore_member, (*source_of(type(self)), int(self))


class MavFlag(IntFlag):
    """Base of the bitmask classes."""

    @classmethod
    def definition(cls) -> EnumDefinition:
        """Return the definition of the enum, with the entries of all files.

        Returns:
            The definition, with descriptions and command parameters.
        """
        return definition_of(cls)

    @property
    def official_name(self) -> str:
        """Names in the definition, joined by `|`; bits without a name as one number."""
        return "|".join(flag_names(self, official_names(type(self))))

    def __reduce_ex__(self, _protocol: object) -> tuple[Any, ...]:
        return restore_member, (*source_of(type(self)), int(self))

    @classmethod
    def _missing_(cls, value: object) -> MavFlag | None:
        if not isinstance(value, int):
            return None
        if value < 0:
            every_bit = max(member.value for member in cls.__members__.values()) if cls.__members__ else 0
            value &= (1 << max(every_bit.bit_length(), value.bit_length())) - 1
            return cls(value)
        member = int.__new__(cls, value)
        member._value_ = value
        names = flag_names(value, _bit_names(cls))
        member._name_ = None if names == [str(value)] else "|".join(names)
        return member


def flag_names(value: int, names: dict[int, str]) -> list[str]:
    """Return the names of the bits set in `value`, and the bits without a name as a number."""
    value = int(value)
    if value in names:
        return [names[value]]
    found = []
    for bit, name in names.items():
        if bit.bit_count() == 1 and value & bit:
            found.append(name)
            value &= ~bit
    return [*found, str(value)] if value or not found else found


def _cached_on_class(enum: EnumClass, name: str, make: Callable[[], Any]) -> Any:  # noqa: ANN401 (the type of `make`)
    """Cache the result of `make` on the enum class; a global cache would keep a user's dialect alive."""
    attribute = f"__mavlink_{name}__"
    if attribute not in enum.__dict__:
        setattr(enum, attribute, make())
    return enum.__dict__[attribute]


def _bit_names(enum: type[MavFlag]) -> dict[int, str]:
    """Return Python names by value."""
    names: dict[int, str] = _cached_on_class(enum, "bit_names", lambda: _names_of_members(enum))
    return names


def _names_of_members(enum: EnumClass) -> dict[int, str]:
    return _first_names((member.value, name) for name, member in enum.__members__.items())


def _first_names(pairs: Iterable[tuple[int, str]]) -> dict[int, str]:
    """Return the first name of each value, in order."""
    names: dict[int, str] = {}
    for value, name in pairs:
        names.setdefault(value, name)
    return names


def reserved_names(bitmask: bool) -> Iterable[str]:
    """Return the names that members may not have, because the class uses them."""
    base = MavFlag if bitmask else MavEnum
    return [*dir(base), *dir(type(base)), "name", "value", "mro", *dir(int)]


def make_enum(
    dialect: Dialect, official: str, name: str, members: dict[str, int], *, bitmask: bool
) -> EnumClass:
    """Create the class of an enum of `dialect`; `members` are values by Python name."""
    base: Any = MavFlag if bitmask else MavEnum
    enum_class: Any = base(name, list(members.items()), module=dialect.module_name, qualname=name)
    enum_class.__mavlink_source__ = (dialect, official)
    return enum_class  # type: ignore[no-any-return]


def source_of(enum: EnumClass) -> tuple[Dialect, str]:
    """Return the dialect of an enum class, and the name of the enum."""
    source: tuple[Dialect, str] = enum.__dict__["__mavlink_source__"]
    return source


def definition_of(enum: EnumClass) -> EnumDefinition:
    """Return the definition of an enum class."""
    dialect, official = source_of(enum)
    return dialect.enum_definition(official)


def official_names(enum: EnumClass) -> dict[int, str]:
    """Return the names of the entries by value."""
    names: dict[int, str] = _cached_on_class(enum, "official_names", lambda: _names_of_entries(enum))
    return names


def _names_of_entries(enum: EnumClass) -> dict[int, str]:
    dialect, official = source_of(enum)
    return _first_names((value, name) for name, value in dialect.enum_values(official).items())


def marked_values(dialect: Dialect, official: str, mark: str) -> frozenset[int]:
    """Return the values of an enum of which the entries have a mark, such as `has_location`."""
    rows = (row for file in dialect.enum_files[official] for row in file.table.enum_row(official)[1])
    return frozenset(value for value, _, metadata in rows if metadata.get(mark))


def enum_reader(enum: EnumClass) -> EnumReader:
    """Return the conversion of integers to members, for the core."""
    reader: EnumReader = _cached_on_class(enum, "reader", lambda: _make_reader(enum))
    return reader


def _make_reader(enum: EnumClass) -> EnumReader:
    members: dict[int, int] = {member.value: member for member in enum.__members__.values()}
    if not members or not issubclass(enum, MavFlag):
        return members, None

    @lru_cache(maxsize=MAX_CACHED_COMBINATIONS)
    def combination(value: int) -> int:
        return enum(value) if value >= 0 else value

    return members, combination


def restore_member(dialect: Dialect, official: str, value: int) -> int:
    """Restore a pickled member, as a plain integer if the dialect has no such member."""
    enum = dialect.enums[official]
    members, fallback = enum_reader(enum)
    return members.get(value, fallback(value) if fallback else value)


class EnumMapping(Mapping[str, EnumClass]):
    """The enum classes of a dialect by name, such as `MAV_CMD`."""

    def __init__(self, dialect: EnumFiles) -> None:
        self._dialect = dialect

    def __getitem__(self, name: str) -> EnumClass:
        return self._dialect.enum_class(name) if name in self else self._missing(name)

    def _missing(self, name: str) -> EnumClass:
        raise KeyError(name)

    def __contains__(self, name: object) -> bool:
        return name in self._dialect.enum_files

    def __iter__(self) -> Iterator[str]:
        return iter(self._dialect.enum_files)

    def __len__(self) -> int:
        return len(self._dialect.enum_files)
