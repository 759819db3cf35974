"""The state of a parameter client, as its operations use it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.services.parameters.value import Encoding, Parameter, Value
    from mavstack.services.timing import RoundTrip


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


class ParameterCache(Protocol):
    """The parameters of one component as received so far; implemented by `ParameterClient`."""

    round_trip: RoundTrip
    received: ReceivedParameter | None
    remote_hash: int | None

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """All received parameters, by name."""

    @property
    def encoding(self) -> Encoding:
        """The encoding of values."""

    def set_complete(self, names: list[str], remote_hash: int | None) -> None:
        """Record that these are all parameters, in their order; others are removed."""

    def load_snapshot(self, snapshot: Snapshot, remote_hash: int, now: float) -> None:
        """Use the parameters of a snapshot."""

    def report_rounded(self, name: str, requested: Value, sent: Value) -> None:
        """Report that a value lost digits."""
