"""The steps from one configuration to another, for a reload that leaves unchanged links alone.

An endpoint is closed and opened again only if its transport changes: its URL, its file, or its profile.
Filters, rates, groups and pauses change while it is open, without a packet lost. Endpoints are removed before
others are added, so that a port can move from one to another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from mavstack.router.config import EndpointConfig, RouterConfig

#: Settings that the router reads only when it starts.
_FIXED: Final = ("duplicate_window", "control", "control_token", "metrics", "dialect")


@dataclass(frozen=True, slots=True)
class Add:
    """Open an endpoint that does not exist."""

    endpoint: EndpointConfig


@dataclass(frozen=True, slots=True)
class Remove:
    """Close an endpoint."""

    name: str


@dataclass(frozen=True, slots=True)
class Reconfigure:
    """Give an open endpoint other filters, rates, another group, or another state."""

    endpoint: EndpointConfig


@dataclass(frozen=True, slots=True)
class NeedsRestart:
    """A setting that changes only when the router starts again."""

    setting: str


Step: TypeAlias = Add | Remove | Reconfigure | NeedsRestart


def steps_between(old: RouterConfig, new: RouterConfig) -> tuple[Step, ...]:
    """Return the steps that lead from one configuration to another, in the order in which they are made.

    Args:
        old: The configuration of the running router.
        new: The requested configuration.

    Returns:
        The steps; none if nothing differs but the order of the endpoints.
    """
    before = {each.name: each for each in old.endpoints}
    after = {each.name: each for each in new.endpoints}
    reopened = {
        name
        for name, each in after.items()
        if name in before and _transport(before[name]) != _transport(each)
    }
    removals = [Remove(name) for name in before if name not in after or name in reopened]
    changes = [
        Reconfigure(each)
        for name, each in after.items()
        if name in before and name not in reopened and before[name] != each
    ]
    additions = [Add(each) for name, each in after.items() if name not in before or name in reopened]
    fixed = [NeedsRestart(name) for name in _FIXED if getattr(old, name) != getattr(new, name)]
    return (*removals, *changes, *additions, *fixed)


def applicable(old: RouterConfig, new: RouterConfig) -> RouterConfig:
    """Return the part of a configuration that a running router can change to.

    Args:
        old: The configuration of the running router.
        new: The requested configuration.

    Returns:
        The requested configuration with the present values of the settings that need a restart, so that each
        later reload names them too.
    """
    return replace(new, **{name: getattr(old, name) for name in _FIXED})


def _transport(endpoint: EndpointConfig) -> tuple[object, ...]:
    """Return the part of an endpoint that cannot change while it is open."""
    return endpoint.url, endpoint.record, endpoint.high_latency
