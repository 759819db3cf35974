"""Addresses of components, and the targets of messages.

A message with `target_system` and `target_component` is addressed; 0 in either of them means all. So is
MANUAL_CONTROL, whose field is called `target`. A message without them is a broadcast.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.dialects import Message


class Address(NamedTuple):
    """The address of a component: its system id and component id; 0 means all."""

    system: int
    component: int

    def __str__(self) -> str:
        return f"{self.system}/{self.component}"

    def covers(self, other: Address) -> bool:
        """Return whether a message to this address is also addressed to `other`."""
        return self.system in (0, other.system) and self.component in (0, other.component)


BROADCAST = Address(0, 0)


def target_of(message: Message) -> Address:
    """Return the target of a message; `BROADCAST` for a broadcast."""
    system = getattr(message, "target_system", None)
    if system is None:
        return Address(getattr(message, "target", 0), 0)
    return Address(system, getattr(message, "target_component", 0))


@lru_cache(maxsize=256)
def target_fields(kind: type[Message]) -> tuple[str, ...]:
    """Return the fields `target_system` and `target_component` that the messages of a class have."""
    names = ("target_system", "target_component")
    return tuple(name for name in names if name in kind.__match_args__)


def message_ids(*classes: type[Message]) -> frozenset[int]:
    """Return the ids of message classes, for `Service.handles`."""
    return frozenset(kind.__mavlink_row__[0] for kind in classes)


def describe(addresses: Iterable[Address]) -> str:
    """Return addresses as text: "1/1, 2/1"."""
    return ", ".join(str(address) for address in sorted(addresses)) or "none"
