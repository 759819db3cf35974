"""The subjects of a quarantine, and the rule that cuts off one of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from mavstack.router.firewall.compiler import PREFIX
from mavstack.router.rules import Rule

if TYPE_CHECKING:
    from mavstack.services import Address

#: The subject of a quarantine: an address (its identity is proven, or it is alone on its link), the whole
#: link (None), or one peer of a listening UDP socket.
Quarantined: TypeAlias = "Address | Remote | None"


class Remote(NamedTuple):
    """The remote address of a peer."""

    host: str
    port: int

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


def quarantine_rule(source: Address | None) -> Rule:
    """Return the rule that drops the packets of a source in quarantine.

    Args:
        source: The source; None: the whole link.

    Returns:
        The rule.
    """
    name = f"{PREFIX}quarantine"
    if source is None:
        return Rule("drop", name=name)
    return Rule(
        "drop", systems=frozenset({source.system}), components=frozenset({source.component}), name=name
    )
