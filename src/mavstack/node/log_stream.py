"""The log of a remote component while it is written: `component.log_stream`.

    async with component.log_stream.open() as stream:
        async for data in stream:
            file.write(data)

The bytes are a valid ULog at any time: only complete messages are delivered, and where the link lost some,
the log has a dropout message of the length of the gap.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import MavstackError, RemoteTimeout
from mavstack.node.api_object import ReadOnly
from mavstack.services.command import Command, CommandOperation
from mavstack.services.log_streaming import LogStreamData, LogStreamReceiver

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.node.clients import ComponentClients

#: Maximum number of pieces of the log that are queued until the program reads them.
_QUEUE: Final = 100_000
_STOP_TIMEOUT: Final = 2.0
#: Seconds without data after which a stream has ended: the vehicle rebooted, or the link is down.
IDLE_TIMEOUT: Final = 15.0


class LogStreams(ReadOnly):
    """The log of a component, streamed (LOGGING_DATA); PX4 has it."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    def open(self) -> LogStream:
        """Return a context manager during which the component streams its log (MAV_CMD_LOGGING_START).

        Returns:
            The stream. Entering it raises CommandDenied if the component streams no log, or streams it to
            another client, and CommandTimeout if it does not answer.
        """
        return LogStream(self._clients)


class LogStream(ReadOnly):
    """The log of a component; made by `LogStreams.open`, an async iterator of its bytes."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients
        self._receiver = LogStreamReceiver(clients.host.address, clients.address)
        self._data = clients.host.events(LogStreamData, of=self._receiver, queue=_QUEUE)

    @property
    def blocks(self) -> int:
        """Blocks of up to 249 bytes that were received."""
        return self._receiver.blocks

    @property
    def lost(self) -> int:
        """Blocks that the link lost."""
        return self._receiver.lost

    @property
    def size(self) -> int:
        """The size of the log so far, in bytes."""
        return self._receiver.assembler.size

    async def __aenter__(self) -> Self:
        self._clients.host.serve(self._receiver)
        try:
            await self._command(common.MavCmd.LOGGING_START)
        except BaseException:
            self._close()
            raise
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._clients.host.is_open:
                await self._command(common.MavCmd.LOGGING_STOP, timeout=_STOP_TIMEOUT)
        except MavstackError:  # the component ends the stream by itself when acknowledgements are missing
            return
        finally:
            self._close()

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> bytes:
        """Return the next bytes of the log.

        Raises:
            StopAsyncIteration: The connection was closed.
            RemoteTimeout: The component sends no more of its log.
        """
        try:
            async with asyncio.timeout(IDLE_TIMEOUT):
                event: LogStreamData = await anext(self._data)
        except TimeoutError:
            target, answer = str(self._clients.address), f"no data for {IDLE_TIMEOUT:g} s"
            raise RemoteTimeout("streaming the log of", target, answer=answer) from None
        return event.data

    def drain(self) -> bytes:
        """Return the bytes that were received and not read yet."""
        return b"".join(event.data for event in self._data.drain())

    def _close(self) -> None:
        self._data.close()
        self._clients.host.remove(self._receiver)

    async def _command(self, number: int, *, timeout: float | None = None) -> None:
        host = self._clients.host
        command = Command.of(host.named_command(number), (), None)
        await host.run_operation(self._clients.command, CommandOperation(command, timeout=timeout))
