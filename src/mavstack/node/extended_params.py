"""The extended parameters of a remote component: `component.extended_params`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.api_object import ReadOnly
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.services.extended_parameters import ExtendedParameterChanged, ExtendedParameterClient

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.node.clients import ComponentClients
    from mavstack.node.subscription import Subscription
    from mavstack.services.extended_parameters import ExtendedParameter, ExtendedValue


class ExtendedParams(ReadOnly):
    """The extended parameters of a remote component, such as a camera: texts and numbers of all sizes."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    @property
    def _client(self) -> ExtendedParameterClient:
        return self._clients.get(ExtendedParameterClient)

    @property
    def cached(self) -> Mapping[str, ExtendedParameter]:
        """Every extended parameter received so far, by name."""
        return self._client.parameters

    async def get(self, name: str, *, timeout: float | None = None) -> ExtendedParameter:
        """Get one extended parameter (PARAM_EXT_REQUEST_READ).

        Args:
            name: The name of the parameter.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The parameter with its value and type.

        Raises:
            ParameterTimeout: The component does not answer, or has no such parameter.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        return await host.finish(client, client.get(name, host.now(), timeout=timeout))

    async def set(
        self, name: str, value: ExtendedValue, *, timeout: float | None = None
    ) -> ExtendedParameter:
        """Set one extended parameter (PARAM_EXT_SET).

        Args:
            name: The name of the parameter.
            value: The new value.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The parameter with the value that the component holds now.

        Raises:
            ParameterDenied: The component refused the value.
            ParameterTimeout: The component does not answer, or has no such parameter.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        return await host.finish(client, client.set(name, value, host.now(), timeout=timeout))

    async def download(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Mapping[str, ExtendedParameter]:
        """Download all extended parameters (PARAM_EXT_REQUEST_LIST).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the parameters received and the parameters in total.

        Returns:
            All parameters, by name.

        Raises:
            ParameterTimeout: The component does not answer.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        await host.finish(client, client.download(host.now(), timeout=timeout), progress)
        return self.cached

    def changes(self) -> Subscription[ExtendedParameterChanged]:
        """Subscribe to changes of extended parameters, made by any component."""
        client = self._client
        return self._clients.host.events(ExtendedParameterChanged, of=client, queue=DEFAULT_QUEUE)
