"""The recording of a node: every packet that it receives, and every packet that it sends.

The packets of one turn of the event loop are written together. A disk that is full ends the recording, not
the node.
"""

from __future__ import annotations

import asyncio
from contextlib import ExitStack
from typing import TYPE_CHECKING

from mavstack.errors import LogError
from mavstack.node.api_object import ReadOnly
from mavstack.services import Address
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from types import TracebackType
    from typing import Self

    from mavstack.logs.recorder import Recorder
    from mavstack.node.host import NodeHost
    from mavstack.wire import Packet


class Recording(ReadOnly):
    """A running recording; an async context manager that ends it."""

    def __init__(self, host: NodeHost, recorder: Recorder, *, sent: bool) -> None:
        self._host = host
        self._recorder = recorder
        self._flush_handle: asyncio.Handle | None = None
        self._error: LogError | None = None
        # Parses sent bytes; each write to a channel consists of complete packets.
        self._parser = Parser(host.engine.dialect)
        self._steps = ExitStack()
        self._steps.callback(host.packet_dispatch.add((), Address(0, 0), self._on_packet).close)
        if sent:
            host.sent_listeners.append(self._on_sent)
            self._steps.callback(host.sent_listeners.remove, self._on_sent)

    @property
    def packets(self) -> int:
        """Number of packets that were written."""
        return self._recorder.packets

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of the files, oldest first."""
        return tuple(self._recorder.files)

    def close(self) -> None:
        """End the recording. Idempotent.

        Raises:
            LogError: A file could not be written; it keeps the packets before.
        """
        self._end()
        if self._error is not None:
            raise self._error

    def _on_packet(self, packet: Packet) -> None:
        self._add((packet,))

    def _on_sent(self, data: bytes) -> None:
        self._add(self._parser.feed(data))

    def _add(self, packets: Sequence[Packet]) -> None:
        try:
            self._recorder.add(packets, self._host.now())
        except LogError as error:
            self._fail(error)
            return
        if self._flush_handle is None:
            self._flush_handle = asyncio.get_running_loop().call_soon(self._flush)

    def _flush(self) -> None:
        self._flush_handle = None
        try:
            self._recorder.flush()
        except LogError as error:
            self._fail(error)

    def _fail(self, error: LogError) -> None:
        """End the recording, and tell it once; `close` raises the error."""
        self._error = error
        self._end()
        context = {"message": f"the recording ended: {error}", "exception": error}
        asyncio.get_running_loop().call_exception_handler(context)

    def _end(self) -> None:
        self._steps.close()
        if self._flush_handle is not None:
            self._flush_handle.cancel()
            self._flush_handle = None
        try:
            self._recorder.close()
        except LogError as error:
            self._error = self._error or error

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
