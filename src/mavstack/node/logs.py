"""The logs of a remote component: `component.logs`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.api_object import ReadOnly
from mavstack.services.log import LogClient

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.clients import ComponentClients
    from mavstack.services.log import LogEntry


class Logs(ReadOnly):
    """The logs stored on a remote component, by the log protocol (LOG_REQUEST_LIST, LOG_REQUEST_DATA)."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    @property
    def _client(self) -> LogClient:
        return self._clients.get(LogClient)

    async def list(self, *, timeout: float | None = None) -> tuple[LogEntry, ...]:
        """List the logs, with their ids, sizes in bytes and times.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            One entry per log, in the order of the ids.

        Raises:
            LogTimeout: The component does not answer.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        return await host.finish(client, client.list_logs(host.now(), timeout=timeout))

    async def download(
        self,
        log: LogEntry | int,
        *,
        max_size: int | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> bytes:
        """Download a log.

        Args:
            log: The entry from `list`, or the id of the log.
            max_size: The largest accepted size in bytes; None: twice its listed size and 1 MiB.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the bytes received and the bytes in total.

        Returns:
            The complete log.

        Raises:
            LogTimeout: The component does not answer, or has no such log, or sends too slowly.
            RemoteProtocolError: The log is larger than allowed, or its chunks contradict each other.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        return await host.finish(
            client, client.download(log, host.now(), max_size=max_size, timeout=timeout), progress
        )

    async def erase(self, *, timeout: float | None = None) -> None:
        """Erase all logs (LOG_ERASE), and verify that the list is empty.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            LogTimeout: The component does not answer, or still lists logs.
            RemoteCancelled: The node was closed.
        """
        host, client = self._clients.host, self._client
        await host.finish(client, client.erase(host.now(), timeout=timeout))
