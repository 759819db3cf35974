"""The state of an extended parameter client, as its operations use it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.services.extended_parameters.value import ExtendedParameter
    from mavstack.services.timing import RoundTrip


@dataclass(frozen=True, slots=True)
class ReceivedExtendedParameter:
    """A PARAM_EXT_VALUE or PARAM_EXT_ACK: `result` is None in the former, `count` is 0 in the latter."""

    parameter: ExtendedParameter
    count: int
    result: int | None
    reordered: bool


class ExtendedParameterCache(Protocol):
    """The parameters of one component as received so far; implemented by `ExtendedParameterClient`."""

    round_trip: RoundTrip
    received: ReceivedExtendedParameter | None

    @property
    def parameters(self) -> Mapping[str, ExtendedParameter]:
        """All received extended parameters, by name."""

    def set_complete(self, names: list[str]) -> None:
        """Record that these are all parameters, in their order; others are removed."""
