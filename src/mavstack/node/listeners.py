"""Which services want to see a packet: looked up by its id and by the system it comes from.

A client hears one system, a server everybody; so a packet costs what its own listeners cost, however many
vehicles there are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from mavstack.services import Service
    from mavstack.wire import Packet

Key: TypeAlias = tuple[int, int]  # message id, system (0: of everybody)


class Listeners:
    """Services by what they listen to; `update` moves a service whose `handles` changed."""

    def __init__(self) -> None:
        self._known: dict[Service, frozenset[int]] = {}
        self._by_key: dict[Key, list[Service]] = {}

    def update(self, service: Service) -> None:
        """Look at what the service listens to now."""
        before = self._known.get(service, frozenset())
        if service.handles is before:
            return
        system = service.hears.system
        for message_id in before - service.handles:
            self._by_key[message_id, system].remove(service)
        for message_id in service.handles - before:
            self._by_key.setdefault((message_id, system), []).append(service)
        self._known[service] = service.handles

    def remove(self, service: Service) -> None:
        """The service is gone."""
        for message_id in self._known.pop(service, frozenset()):
            self._by_key[message_id, service.hears.system].remove(service)

    def of(self, packet: Packet) -> list[Service]:
        """Who wants to see the packet."""
        everybodys = self._by_key.get((packet.message_id, 0), ())
        systems = self._by_key.get((packet.message_id, packet.system), ())
        return [*everybodys, *systems]
