"""The content of a parameter file."""

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
    """One parameter of a file; attributes that the format does not hold are None.

    Attributes:
        name: The name.
        value: The value; an int if it is written as one.
        type: The MAV_PARAM_TYPE.
        component: The component id.
        read_only: True if the file has ArduPilot's mark @READONLY.
        text: The value as it is written in the file; empty if it was not read from one.
    """

    name: str
    value: Value
    type: int | None = None
    component: int | None = None
    read_only: bool = False
    text: str = field(default="", compare=False)

    @property
    def value_text(self) -> str:
        """The value as files and texts show it."""
        if self.type == common.MavParamType.REAL64:
            return repr(float(self.value))
        return write_number(self.value)


@dataclass(frozen=True, slots=True)
class ParameterFile:
    """The parameters of a file in their order.

    Attributes:
        parameters: The parameters.
        system: The system id, if the format holds it.
        comments: The comments at the head of the file, one per line, without `#`.
    """

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
        """Return a file with parameters of a component.

        Args:
            parameters: The parameters, such as `vehicle.params.cached.values()`.
            system: The system id.
            component: The component id.
            comments: The comments at the head of the file.
        """
        stored = (StoredParameter(each.name, each.value, int(each.type), component) for each in parameters)
        return cls(tuple(stored), system, tuple(comments))

    def by_name(self, component: int = _AUTOPILOT) -> dict[str, StoredParameter]:
        """Return the parameters of a component, and those without one, by name; the last of a name counts."""
        return {each.name: each for each in self.parameters if each.component in (None, component)}

    @property
    def components(self) -> tuple[int, ...]:
        """The component ids in the file, if its format holds them."""
        return tuple(sorted({each.component for each in self.parameters if each.component is not None}))


def is_name(text: str) -> bool:
    """Return whether a text can be the name of a parameter in a file."""
    return 1 <= len(text) <= NAME_LENGTH and all("!" < each <= "~" and each not in "#,=" for each in text)
