"""Enum classes, made on first use: `IntEnum`, and for bitmasks `IntFlag`.

A value that an `IntEnum` does not know stays a plain integer wherever a message is read. A bitmask reads as
its `IntFlag` whatever bits are set; `enum` would keep every combination it ever met, so that a stream of
random masks could fill the memory, and `_missing_` here makes them without keeping any.
"""

from __future__ import annotations

from enum import IntEnum, IntFlag
from functools import lru_cache

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any, TypeAlias

    from mavstack.dialects.dialect import Dialect
    from mavstack.dialects.model import EnumDefinition

#: How many combinations of a bitmask are kept at hand, an enum.
_KEPT_COMBINATIONS = 256

EnumClass: TypeAlias = "type[MavEnum | MavFlag]"
#: Members by value, and what to call for a value that has none.
EnumReader: TypeAlias = "tuple[dict[int, int], Callable[[int], int] | None]"


class MavEnum(IntEnum):
    """Base of the enums whose values exclude each other."""

    @classmethod
    def definition(cls) -> EnumDefinition:
        """What the dialect says about the enum, additions by other files included."""
        return definition_of(cls)

    @property
    def official_name(self) -> str:
        """The name in the definition: `MAV_CMD_NAV_TAKEOFF`."""
        return official_names(type(self))[self.value]

    def __reduce_ex__(self, _protocol: object) -> tuple[Any, ...]:
        return restore_member, (*source_of(type(self)), int(self))


class MavFlag(IntFlag):
    """Base of the bitmask enums."""

    @classmethod
    def definition(cls) -> EnumDefinition:
        """What the dialect says about the enum, additions by other files included."""
        return definition_of(cls)

    @property
    def official_name(self) -> str:
        """The names in the definition, joined by `|`; bits that have none as one number."""
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
    """The names of the single bits set in `value`, in the order of `names`, and what is left as a number."""
    value = int(value)
    if value in names:
        return [names[value]]
    found = []
    for bit, name in names.items():
        if bit.bit_count() == 1 and value & bit:
            found.append(name)
            value &= ~bit
    return [*found, str(value)] if value or not found else found


def _kept(enum: EnumClass, name: str, make: Callable[[], Any]) -> Any:  # noqa: ANN401 (what `make` gives)
    """What `make` gives, kept with the enum class: a cache beside it would keep a user's dialect alive."""
    attribute = f"__mavlink_{name}__"
    if attribute not in enum.__dict__:
        setattr(enum, attribute, make())
    return enum.__dict__[attribute]


def _bit_names(enum: type[MavFlag]) -> dict[int, str]:
    """Python names by value."""
    names: dict[int, str] = _kept(enum, "bit_names", lambda: _names_of_members(enum))
    return names


def _names_of_members(enum: EnumClass) -> dict[int, str]:
    return _first_names((member.value, name) for name, member in enum.__members__.items())


def _first_names(pairs: Iterable[tuple[int, str]]) -> dict[int, str]:
    """The first name of each value, in order."""
    names: dict[int, str] = {}
    for value, name in pairs:
        names.setdefault(value, name)
    return names


def reserved_names(bitmask: bool) -> Iterable[str]:
    """Names that members may not have, because the class uses them."""
    base = MavFlag if bitmask else MavEnum
    return [*dir(base), *dir(type(base)), "name", "value", "mro", *dir(int)]


def make_enum(
    dialect: Dialect, official: str, name: str, members: dict[str, int], *, bitmask: bool
) -> EnumClass:
    """The class of an enum of `dialect`; `members` are values by Python names."""
    base: Any = MavFlag if bitmask else MavEnum
    made: Any = base(name, list(members.items()), module=dialect.module_name, qualname=name)
    made.__mavlink_source__ = (dialect, official)
    return made  # type: ignore[no-any-return]


def source_of(enum: EnumClass) -> tuple[Dialect, str]:
    """The dialect that an enum class belongs to, and its official name."""
    source: tuple[Dialect, str] = enum.__dict__["__mavlink_source__"]
    return source


def definition_of(enum: EnumClass) -> EnumDefinition:
    """What the dialect says about an enum."""
    dialect, official = source_of(enum)
    return dialect.enum_definition(official)


def official_names(enum: EnumClass) -> dict[int, str]:
    """Official names by value."""
    names: dict[int, str] = _kept(enum, "official_names", lambda: _names_of_entries(enum))
    return names


def _names_of_entries(enum: EnumClass) -> dict[int, str]:
    return _first_names((entry.value, entry.name) for entry in definition_of(enum).entries)


def enum_reader(enum: EnumClass) -> EnumReader:
    """How the core turns integers into members of `enum`."""
    reader: EnumReader = _kept(enum, "reader", lambda: _make_reader(enum))
    return reader


def _make_reader(enum: EnumClass) -> EnumReader:
    members: dict[int, int] = {member.value: member for member in enum.__members__.values()}
    if not members or not issubclass(enum, MavFlag):
        return members, None

    @lru_cache(maxsize=_KEPT_COMBINATIONS)
    def combination(value: int) -> int:
        return enum(value) if value >= 0 else value

    return members, combination


def restore_member(dialect: Dialect, official: str, value: int) -> int:
    """The member that was pickled; a plain integer if the dialect no longer knows it."""
    enum = dialect.enums[official]
    members, fallback = enum_reader(enum)
    return members.get(value, fallback(value) if fallback else value)
