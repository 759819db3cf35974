"""The settings that the URLs of a node's links give: its address, heartbeats, versions and keys.

A URL is more specific than the arguments of the node and wins over them. The address and the heartbeats
belong to the node as a whole: two URLs must not contradict each other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.errors import InvalidArgumentError
from mavstack.security.key_store import find_key
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.links import Link, LinkSettings
    from mavstack.security import SigningKey

Value = TypeVar("Value")


def local_address(links: Sequence[Link], system: int, component: int) -> Address:
    """Return the address of the node: that of a URL, or the one of the arguments.

    Raises:
        InvalidArgumentError: An id is not in 1 to 255, or two URLs contradict each other.
    """
    system = _agreed(links, "id", lambda settings: settings.system, system)
    component = _agreed(links, "id", lambda settings: settings.component, component)
    if not (0 < system < 256 and 0 < component < 256):
        raise InvalidArgumentError(
            f"invalid address {system}/{component}: system and component must be 1 to 255"
        )
    return Address(system, component)


def heartbeat_interval(links: Sequence[Link], rate: float) -> float | None:
    """Return the seconds between two heartbeats from their rate in hertz; None for none.

    Raises:
        InvalidArgumentError: The rate is negative or not finite, or two URLs contradict each other.
    """
    rate = _agreed(links, "heartbeat_rate", lambda settings: settings.heartbeat_rate, rate)
    if not 0 <= rate < float("inf"):
        raise InvalidArgumentError(f"heartbeat_rate must be 0 or more and finite, got {rate}")
    return 1 / rate if rate else None


def link_keys(links: Sequence[Link]) -> dict[Link, SigningKey]:
    """Return the signing keys that the URLs name; raises SigningError if one cannot be read."""
    return {link: find_key(link.settings.signing_key) for link in links if link.settings.signing_key}


def _agreed(
    links: Sequence[Link], option: str, get: Callable[[LinkSettings], Value | None], default: Value
) -> Value:
    given = {value for link in links if (value := get(link.settings)) is not None}
    if len(given) > 1:
        raise InvalidArgumentError(f"the links of a node must agree on the option {option}")
    return given.pop() if given else default
