"""Admission of new components: bounds against floods of forged heartbeats.

New components of one channel are limited in rate, so that a flood neither costs much nor fills the table at
once. A full table makes room for each new component: lost ones are removed first, then those that were heard
for a moment only, and those with verified packets last.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.services.addressing import Address
    from mavstack.services.heartbeat.component_info import ComponentInfo

#: The largest number of components in the table; real networks are far smaller.
MAX_COMPONENTS = 4096
#: The number of components that are removed from a full table in one step.
REMOVED_AT_ONCE = 256
#: The number of new components that one channel may add at once.
MAX_NEW_BURST = 256.0
#: The number of new components that one channel may add per second after that.
MAX_NEW_RATE = 100.0
#: Seconds between the first and the last packet of a component: a full table removes components below this
#: duration before the components above it, unless their packets are verified by signatures.
MIN_HEARD_DURATION = 2.5
MAX_CHANNELS = 512


class NewComponentLimit:
    """The rate limit of new components, by the name of the channel."""

    def __init__(self) -> None:
        self._budgets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def admits(self, channel: str, now: float) -> bool:
        """Return whether a channel may add a component now, and count it if so."""
        budget, updated_at = self._budgets.pop(channel, (MAX_NEW_BURST, now))
        budget = min(budget + max(now - updated_at, 0.0) * MAX_NEW_RATE, MAX_NEW_BURST)
        admitted = budget >= 1.0
        self._budgets[channel] = (budget - admitted, now)
        if len(self._budgets) > MAX_CHANNELS:
            self._budgets.popitem(last=False)
        return admitted


def components_to_remove(
    components: Iterable[ComponentInfo], is_verified: Callable[[Address], bool]
) -> list[ComponentInfo]:
    """Return the components that a full table removes to make room for new ones."""

    def order(info: ComponentInfo) -> tuple[bool, bool, bool, float]:
        was_heard_long = info.last_seen - info.first_seen >= MIN_HEARD_DURATION
        return is_verified(info.address), was_heard_long, info.alive, info.last_seen

    return sorted(components, key=order)[:REMOVED_AT_ONCE]
