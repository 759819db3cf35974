"""The parameter table of a component: types, limits and values, in a fixed order.

The position is the index on the wire. Parameters can be added and removed while clients download the list;
they notice the change by the count.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.parameters.hashing import HASH_NAME, hash_of
from mavstack.services.parameters.packed import MAX_PARAMETERS, write
from mavstack.services.parameters.value import Parameter, Value, as_type, fitted, name_field, same

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(slots=True)
class ParameterDefinition:
    """One parameter of a table; see `ParameterServer.add`."""

    name: str
    value: Value
    type: int | None = None
    minimum: Value | None = None
    maximum: Value | None = None
    default: Value | None = None
    read_only: bool = False
    volatile: bool = False

    def __post_init__(self) -> None:
        if self.type is None:
            kind = common.MavParamType
            self.type = kind.REAL32 if isinstance(self.value, float) else kind.INT32
        self.value = as_type(name_field(self.name), self.value, self.kind)
        if self.name == HASH_NAME:
            raise InvalidArgumentError(f"a parameter cannot be named {HASH_NAME}, the name of the hash")

    @property
    def kind(self) -> int:
        """The MAV_PARAM_TYPE."""
        return common.MavParamType.REAL32 if self.type is None else self.type

    def refusal(self, value: Value) -> common.MavParamError | None:
        """Return the reason why a client may not set a value, or None.

        NaN and infinities are refused, as by ArduPilot, unless the default is such a value.
        """
        if self.read_only:
            return common.MavParamError.READ_ONLY
        held = fitted(value, self.kind)
        if held is None:
            return common.MavParamError.VALUE_OUT_OF_RANGE
        if not isfinite(held):
            is_default = self.default is not None and same(held, self.default)
            return None if is_default else common.MavParamError.VALUE_OUT_OF_RANGE
        low = self.minimum is not None and held < self.minimum
        high = self.maximum is not None and held > self.maximum
        return common.MavParamError.VALUE_OUT_OF_RANGE if low or high else None


class ParameterTable:
    """The parameters in their order."""

    def __init__(self) -> None:
        self._definitions: dict[str, ParameterDefinition] = {}
        self._order: list[str] = []
        self._places: dict[str, int] = {}

    def __len__(self) -> int:
        return len(self._order)

    def __contains__(self, name: object) -> bool:
        return name in self._definitions

    def __getitem__(self, name: str) -> ParameterDefinition:
        return self._definitions[name]

    def __iter__(self) -> Iterator[ParameterDefinition]:
        return iter([self._definitions[name] for name in self._order])

    def add(self, definition: ParameterDefinition) -> None:
        """Add a parameter at the end."""
        if definition.name in self._definitions or len(self) >= MAX_PARAMETERS:
            raise InvalidArgumentError(
                f"cannot add parameter {definition.name}: it exists, or the table is full"
            )
        self._definitions[definition.name] = definition
        self._places[definition.name] = len(self._order)
        self._order.append(definition.name)

    def remove(self, name: str) -> None:
        """Remove a parameter; those behind it move up."""
        if name not in self._definitions:
            raise InvalidArgumentError(f"there is no parameter {name}")
        del self._definitions[name]
        self._order.remove(name)
        self._places = {known: place for place, known in enumerate(self._order)}

    def find(self, which: str | int) -> ParameterDefinition | None:
        """Return a parameter by name or index."""
        if isinstance(which, int):
            return self._definitions[self._order[which]] if 0 <= which < len(self._order) else None
        return self._definitions.get(which)

    def index_of(self, name: str) -> int:
        """Return the index of a parameter."""
        return self._places[name]

    def parameter(self, name: str) -> Parameter:
        """Return a parameter as clients see it."""
        definition = self._definitions[name]
        return Parameter(name, definition.value, definition.kind, self._places[name])

    def parameters(self) -> list[Parameter]:
        """Return all parameters as clients see them."""
        return [self.parameter(name) for name in self._order]

    def hash(self) -> int:
        """Return the hash for `_HASH_CHECK`."""
        return hash_of(self.parameter(definition.name) for definition in self if not definition.volatile)

    def packed(
        self,
        *,
        start: int = 0,
        count: int | None = None,
        with_defaults: bool = False,
        block_size: int | None = None,
    ) -> bytes:
        """Encode `@PARAM/param.pck`: up to `count` parameters from `start` on, padded for `block_size`."""
        chosen = self.parameters()[start : None if count is None else start + count]
        defaults = {
            definition.name: definition.value if definition.default is None else definition.default
            for definition in self
        }
        return write(
            chosen, total=len(self), defaults=defaults if with_defaults else None, block_size=block_size
        )
