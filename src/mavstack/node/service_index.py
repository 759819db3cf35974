"""The services of an engine by the packets that they handle: message id and source system.

A client handles packets of one system, a server those of all systems. The cost of a packet therefore depends
on the services that handle it, and not on the number of vehicles. Lookups are cached until a service changes
its ids.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services import Service

Key: TypeAlias = tuple[int, int]  # message id, system (0: all)

#: Maximum number of cached lookups: without a bound, forged ids could fill the memory.
MAX_CACHED = 4096


class ServiceIndex:
    """Services by message id and system."""

    def __init__(self) -> None:
        self._known: dict[Service, frozenset[int]] = {}
        self._by_key: dict[Key, list[Service]] = {}
        self._cache: dict[Key, tuple[Service, ...]] = {}
        #: Called after a change of services: message ids, and their system (0: all).
        self.on_change: Callable[[frozenset[int], int], None] = lambda ids, system: None

    def update(self, service: Service) -> None:
        """Add a service, or index it again if its `handles` changed."""
        before = self._known.get(service, frozenset())
        if service.handles is before:
            return
        self._cache.clear()
        system = service.source_filter.system
        for message_id in before - service.handles:
            self._by_key[message_id, system].remove(service)
        for message_id in service.handles - before:
            self._by_key.setdefault((message_id, system), []).append(service)
        self._known[service] = service.handles
        self.on_change(before ^ service.handles, system)

    def remove(self, service: Service) -> None:
        """Remove a service."""
        self._cache.clear()
        ids, system = self._known.pop(service, frozenset()), service.source_filter.system
        for message_id in ids:
            self._by_key[message_id, system].remove(service)
        self.on_change(ids, system)

    def find(self, message_id: int, system: int) -> tuple[Service, ...]:
        """Return the services that handle packets of that id from that system."""
        cached = self._cache.get((message_id, system))
        return self._find(message_id, system) if cached is None else cached

    def _find(self, message_id: int, system: int) -> tuple[Service, ...]:
        if len(self._cache) >= MAX_CACHED:
            self._cache.clear()
        keys = [(message_id, each) for each in ((0, system) if system else (0,))]
        found = tuple(service for key in keys for service in self._by_key.get(key, ()))
        self._cache[message_id, system] = found
        return found
