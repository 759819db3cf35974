"""The node layer: a program as a MAVLink component, on asyncio and links.

The names are imported when they are used: a router needs one module of this package, and starts without the
others.
"""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.node.component import RemoteComponent
    from mavstack.node.dispatch import Listener
    from mavstack.node.events import EventListener, EventStream
    from mavstack.node.node import Node
    from mavstack.node.subscription import Subscription

__all__ = ["EventListener", "EventStream", "Listener", "Node", "RemoteComponent", "Subscription"]

_LAZY_IMPORTS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "EventListener": "events",
        "EventStream": "events",
        "Listener": "dispatch",
        "Node": "node",
        "RemoteComponent": "component",
        "Subscription": "subscription",
    }
)


def __getattr__(name: str) -> Any:  # noqa: ANN401 (any of the names above)
    module = _LAZY_IMPORTS.get(name)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{module}"), name)
