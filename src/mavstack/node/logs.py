"""The logs on a vehicle: listed, fetched, erased."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.services.log import LogClient

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.component import RemoteComponent
    from mavstack.services.log import LogEntry


class Logs:
    """The logs of one vehicle; raises `LogTimeout`."""

    def __init__(self, remote: RemoteComponent) -> None:
        self._remote = remote

    @cached_property
    def client(self) -> LogClient:
        """The state machine behind it."""
        return self._remote.node.serve(LogClient(self._remote.node.address, self._remote.address))

    async def list(self, *, timeout: float | None = None) -> tuple[LogEntry, ...]:
        """Which logs there are."""
        node = self._remote.node
        return await node.driver.finish(self.client, self.client.list_logs(node.now(), timeout=timeout))

    async def download(
        self,
        log: LogEntry | int,
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> bytes:
        """Fetch a log, by its entry in the list or by its id."""
        node = self._remote.node
        operation = self.client.download(log, node.now(), timeout=timeout)
        return await node.driver.finish(self.client, operation, progress)

    async def erase(self, *, timeout: float | None = None) -> None:
        """Erase all logs."""
        node = self._remote.node
        await node.driver.finish(self.client, self.client.erase(node.now(), timeout=timeout))
