"""A shell on the vehicle, such as PX4's nsh.

    async with vehicle.shell() as shell:
        shell.write_line("ver all")
        async for text in shell: ...

Leaving the block gives it back.
"""

from __future__ import annotations

from codecs import getincrementaldecoder
from typing import TYPE_CHECKING

from mavstack.services.serial_control import ShellClient, ShellOutput, ShellReleased

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.node.component import RemoteComponent


class Shell:
    """An open shell: write to it, iterate over what it says; leaving it gives it back."""

    def __init__(self, remote: RemoteComponent, client: ShellClient) -> None:
        self._node = remote.node
        self._client = client
        self._output = self._node.events(ShellOutput, of=client, queue=100_000)
        self._decoder = getincrementaldecoder("utf-8")("replace")

    def write(self, data: bytes) -> None:
        """Send bytes."""
        self._client.write(data, self._node.now())
        self._node.wake(self._client)

    def write_line(self, text: str) -> None:
        """Send a text and the end of its line."""
        self._client.write_line(text, self._node.now())
        self._node.wake(self._client)

    async def __aenter__(self) -> Self:
        self._node.serve(self._client)
        self._client.open(self._node.now())
        self._node.wake(self._client)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._node.is_open:
                await self._give_back()
        finally:
            self._output.close()
            self._node.engine.remove(self._client)

    async def _give_back(self) -> None:
        async with self._node.events(ShellReleased, of=self._client) as released:
            self._client.close(self._node.now())
            self._node.wake(self._client)
            await anext(released, None)

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> str:
        return self._decoder.decode((await anext(self._output)).data)
