"""Who speaks to whom: addresses, and whether a message is meant for one.

A message that has `target_system` and `target_component` is addressed; 0 in either stands for all. A message
without them is for everybody who hears it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.dialects import Message


class Address(NamedTuple):
    """A component of a system; 0 stands for all."""

    system: int
    component: int

    def __str__(self) -> str:
        return f"{self.system}/{self.component}"

    def covers(self, other: Address) -> bool:
        """Whether what is sent to this address is also for `other`."""
        return self.system in (0, other.system) and self.component in (0, other.component)


EVERYBODY = Address(0, 0)


def target_of(message: Message) -> Address:
    """To whom a message is addressed; `EVERYBODY` if it does not say."""
    return Address(getattr(message, "target_system", 0), getattr(message, "target_component", 0))


def message_ids(*classes: type[Message]) -> frozenset[int]:
    """The ids of message classes, for `Service.handles`."""
    return frozenset(kind.__mavlink_row__[0] for kind in classes)


def describe(addresses: Iterable[Address]) -> str:
    """Addresses in a text for people: "1/1, 2/1"."""
    return ", ".join(str(address) for address in sorted(addresses)) or "nobody"
