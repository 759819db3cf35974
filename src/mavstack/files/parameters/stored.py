"""Parameters as a file holds them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.files.parameters.numbers import write_number
from mavstack.services.parameters.value import NAME_LENGTH

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Self

    from mavstack.services.parameters import Parameter, Value

_AUTOPILOT = int(common.MavComponent.AUTOPILOT1)


@dataclass(frozen=True, slots=True)
class StoredParameter:
    """One parameter of a file; what its format does not tell is None.

    `text` is the value as the file has it, and empty for what was never in one. `read_only` is ArduPilot's
    mark @READONLY.
    """

    name: str
    value: Value
    type: int | None = None
    component: int | None = None
    read_only: bool = False
    text: str = field(default="", compare=False)

    @property
    def value_text(self) -> str:
        """The value as it is written and shown."""
        if self.type == common.MavParamType.REAL64:
            return repr(float(self.value))
        return write_number(self.value)


@dataclass(frozen=True, slots=True)
class ParameterFile:
    """The parameters of a file in its order, and the comments at its head, a line each, without their `#`."""

    parameters: tuple[StoredParameter, ...]
    system: int | None = None
    comments: tuple[str, ...] = field(default=(), compare=False)

    @classmethod
    def of(
        cls,
        parameters: Iterable[Parameter],
        *,
        system: int | None = None,
        component: int | None = None,
        comments: Iterable[str] = (),
    ) -> Self:
        """What a component told, to be written."""
        stored = (StoredParameter(each.name, each.value, int(each.type), component) for each in parameters)
        return cls(tuple(stored), system, tuple(comments))

    def by_name(self, component: int = _AUTOPILOT) -> dict[str, StoredParameter]:
        """Those of a component, or of none in particular; the last one of a name counts."""
        return {each.name: each for each in self.parameters if each.component in (None, component)}

    @property
    def components(self) -> tuple[int, ...]:
        """Which components the file tells of, if its format tells that."""
        return tuple(sorted({each.component for each in self.parameters if each.component is not None}))


def is_name(text: str) -> bool:
    """Whether a text can be the name of a parameter in a file."""
    return 1 <= len(text) <= NAME_LENGTH and all("!" < each <= "~" and each not in "#,=" for each in text)
