"""The differences between two parameter sets, of files or of vehicles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.files.parameters.numbers import agree, rounds_to
from mavstack.files.parameters.parameter_file import StoredParameter
from mavstack.services.parameters import Parameter

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

AnyParameter: TypeAlias = StoredParameter | Parameter


@dataclass(frozen=True, slots=True)
class Difference:
    """A parameter that both sets have, with different values."""

    name: str
    ours: AnyParameter
    theirs: AnyParameter


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two parameter sets compared by name: different, the same, and in one of them only."""

    different: tuple[Difference, ...]
    same: tuple[str, ...]
    only_ours: tuple[AnyParameter, ...]
    only_theirs: tuple[AnyParameter, ...]

    @property
    def alike(self) -> bool:
        """True if both sets have the same parameters with the same values."""
        return not (self.different or self.only_ours or self.only_theirs)


def compare(ours: Mapping[str, AnyParameter], theirs: Mapping[str, AnyParameter]) -> Comparison:
    """Compare two parameter sets by name; letter case does not matter.

    Args:
        ours: Parameters by name.
        theirs: Parameters by name.

    Returns:
        The differences; values that are the same float32 are the same.
    """
    pairs = matched(ours, theirs)
    different, same = [], []
    for name, mine in sorted(ours.items()):
        if name in pairs:
            other = theirs[pairs[name]]
            if is_same(mine, other):
                same.append(pairs[name])
            else:
                different.append(Difference(pairs[name], mine, other))
    paired = set(pairs.values())
    return Comparison(
        tuple(different),
        tuple(same),
        tuple(each for name, each in sorted(ours.items()) if name not in pairs),
        tuple(each for name, each in sorted(theirs.items()) if name not in paired),
    )


def matched(ours: Iterable[str], theirs: Iterable[str]) -> dict[str, str]:
    """Return the name among `theirs` of each of `ours` that is there, ignoring letter case."""
    known = set(theirs)
    by_upper = {name.upper(): name for name in known}
    found = {}
    for name in ours:
        other = name if name in known else by_upper.get(name.upper())
        if other is not None:
            found[name] = other
    return found


def is_same(one: AnyParameter, other: AnyParameter) -> bool:
    """Return whether two parameters have the same value, within the precision of their types and files."""
    kind = _type_of(one) or _type_of(other)
    if _type_of(one) is not None and _type_of(other) is not None and _type_of(one) != _type_of(other):
        # compare different types with the precision of float32, the least precise type
        kind = int(common.MavParamType.REAL32)
    exact = _is_exact(one) and _is_exact(other)
    return agree(one.value, other.value, kind=kind, exact=exact) or any(
        isinstance(each, StoredParameter) and bool(each.text) and rounds_to(held.value, each.text)
        for each, held in ((one, other), (other, one))
    )


def value_text(parameter: AnyParameter) -> str:
    """Return the value as texts and files show it."""
    if isinstance(parameter, StoredParameter):
        return parameter.value_text
    return StoredParameter(parameter.name, parameter.value, int(parameter.type)).value_text


def _type_of(parameter: AnyParameter) -> int | None:
    return None if parameter.type is None else int(parameter.type)


def _is_exact(parameter: AnyParameter) -> bool:
    return parameter.exact if isinstance(parameter, Parameter) else True
