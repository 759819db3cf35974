"""The state of a parameter client, as its operations use it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.services.parameters.value import Parameter


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A complete parameter set, for example from an earlier connection.

    Attributes:
        parameters: The parameters in the order of the component's table.
        hash: The hash that the component sent for the set, if it did.
    """

    parameters: tuple[Parameter, ...]
    hash: int | None = None


@dataclass(frozen=True, slots=True)
class ReceivedParameter:
    """A PARAM_VALUE; `count` is the size of the table, `reordered` means that newer ones arrived before."""

    parameter: Parameter
    count: int
    reordered: bool
