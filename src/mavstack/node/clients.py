"""The clients of one remote component, each made on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, cast

from mavstack.services import Address
from mavstack.services.command import CommandClient

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.host import NodeHost
    from mavstack.services import Operation, Service
    from mavstack.services.heartbeat import ComponentInfo

AnyClient = TypeVar("AnyClient", bound="Service")


class ComponentClients:
    """The clients of one remote component; the parts of the component share them."""

    def __init__(self, host: NodeHost, address: Address) -> None:
        self.host = host
        self.address = address
        #: The clients that were created so far, by class.
        self.made: dict[object, Service] = {}

    @property
    def info(self) -> ComponentInfo | None:
        """The component's last heartbeat; None if none was received."""
        return self.host.discovery.components.get(self.address)

    @property
    def command(self) -> CommandClient:
        """The client of every command."""
        return self.get(CommandClient)

    def get(
        self, kind: Callable[[Address, Address], AnyClient], make: Callable[[], AnyClient] | None = None
    ) -> AnyClient:
        """Return the client of a class, made and served from the first use on.

        Args:
            kind: The class.
            make: Makes the client; None: the class is called with the addresses of node and component.

        Returns:
            The client.
        """
        known = self.made.get(kind)
        if known is None:
            client = kind(self.host.address, self.address) if make is None else make()
            known = self.made[kind] = self.host.serve(client)
        return cast("AnyClient", known)

    def begin_command(self, operation: Operation[Any], now: float) -> None:
        """Begin an operation of the command client for another client, which does not wait for it."""
        self.command.begin(operation, now)
        self.host.engine.touch(self.command)

    def clear_cache(self) -> None:
        """Discard the state that the clients received before a reboot of the component."""
        now = self.host.now()
        for client in self.made.values():
            client.clear_cache(now)
            self.host.wake(client)

    def sibling(self, component: int) -> ComponentClients:
        """Return the clients of another component of the same system."""
        return ComponentClients(self.host, Address(self.address.system, component))
