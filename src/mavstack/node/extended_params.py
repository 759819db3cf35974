"""The extended parameters of a component, such as a camera: text, and numbers of all sizes."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.services.extended_parameters import ExtendedParameterChanged, ExtendedParameterClient

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.node.component import RemoteComponent
    from mavstack.node.subscription import Subscription
    from mavstack.services.extended_parameters import ExtendedParameter, ExtendedValue


class ExtendedParams:
    """The extended parameters of one component; raises `ParameterDenied` or `ParameterTimeout`."""

    def __init__(self, remote: RemoteComponent) -> None:
        self._remote = remote

    @cached_property
    def client(self) -> ExtendedParameterClient:
        """The state machine behind it."""
        node = self._remote.node
        return node.serve(ExtendedParameterClient(node.address, self._remote.address))

    @property
    def cached(self) -> Mapping[str, ExtendedParameter]:
        """Every extended parameter that was heard of, by name."""
        return self.client.parameters

    async def get(self, name: str, *, timeout: float | None = None) -> ExtendedParameter:
        """Ask for one."""
        node = self._remote.node
        return await node.driver.finish(self.client, self.client.read(name, node.now(), timeout=timeout))

    async def set(
        self, name: str, value: ExtendedValue, *, timeout: float | None = None
    ) -> ExtendedParameter:
        """Set one; the result is what the component holds now."""
        node = self._remote.node
        return await node.driver.finish(self.client, self.client.set(name, value, node.now(), timeout=timeout))

    async def download(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Mapping[str, ExtendedParameter]:
        """Fetch them all."""
        node = self._remote.node
        operation = self.client.fetch_all(node.now(), timeout=timeout)
        await node.driver.finish(self.client, operation, progress)
        return self.cached

    def clear_cache(self) -> None:
        """The component started anew: its parameters are to be asked for again."""
        if "client" in self.__dict__:
            self.client.forget(self._remote.node.now())
            self._remote.node.wake(self.client)

    def changes(self) -> Subscription[ExtendedParameterChanged]:
        """Each one that changes from now on, whoever changes it."""
        return self._remote.node.events(ExtendedParameterChanged, of=self.client)
