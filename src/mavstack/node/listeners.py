"""Which services want to see a packet: looked up by its id and by the system it comes from.

A client hears one system, a server everybody; so a packet costs what its own listeners cost, however many
vehicles there are. What was found for an id and a system is kept until any service listens to something else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from mavstack.services import Service

Key: TypeAlias = tuple[int, int]  # message id, system (0: of everybody)

#: So much of what was found is kept; ids and systems can be forged.
MOST_FOUND = 4096


class Listeners:
    """Services by what they listen to; `update` moves a service whose `handles` changed."""

    def __init__(self) -> None:
        self._known: dict[Service, frozenset[int]] = {}
        self._by_key: dict[Key, list[Service]] = {}
        self._found: dict[Key, tuple[Service, ...]] = {}

    def update(self, service: Service) -> None:
        """Look at what the service listens to now."""
        before = self._known.get(service, frozenset())
        if service.handles is before:
            return
        self._found.clear()
        system = service.source_filter.system
        for message_id in before - service.handles:
            self._by_key[message_id, system].remove(service)
        for message_id in service.handles - before:
            self._by_key.setdefault((message_id, system), []).append(service)
        self._known[service] = service.handles

    def remove(self, service: Service) -> None:
        """The service is gone."""
        self._found.clear()
        for message_id in self._known.pop(service, frozenset()):
            self._by_key[message_id, service.source_filter.system].remove(service)

    def of(self, message_id: int, system: int) -> tuple[Service, ...]:
        """Who wants to see packets of that id from that system."""
        found = self._found.get((message_id, system))
        return self._find(message_id, system) if found is None else found

    def _find(self, message_id: int, system: int) -> tuple[Service, ...]:
        if len(self._found) >= MOST_FOUND:
            self._found.clear()
        keys = [(message_id, heard) for heard in ((0, system) if system else (0,))]
        found = tuple(service for key in keys for service in self._by_key.get(key, ()))
        self._found[message_id, system] = found
        return found
