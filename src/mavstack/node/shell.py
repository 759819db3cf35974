"""A shell on a remote component, such as PX4's nsh, by SERIAL_CONTROL.

    async with component.shell() as shell:
        shell.write_line("ver all")
        async for text in shell: ...

Leaving the block releases the shell.
"""

from __future__ import annotations

from codecs import getincrementaldecoder
from typing import TYPE_CHECKING

from mavstack.node.api_object import ReadOnly
from mavstack.services.serial_control import ShellClient, ShellOutput, ShellReleased

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.node.host import NodeHost
    from mavstack.services import Address

#: Chunks of output that are queued while the program does not read.
OUTPUT_QUEUE = 100_000


class Shell(ReadOnly):
    """A shell: write commands to it, and iterate over its output as text; an async context manager."""

    def __init__(self, host: NodeHost, address: Address) -> None:
        self._host = host
        self._client = ShellClient(host.address, address)
        self._output = host.events(ShellOutput, of=self._client, queue=OUTPUT_QUEUE)
        self._decoder = getincrementaldecoder("utf-8")("replace")

    def write(self, data: bytes) -> None:
        """Send bytes to the shell.

        Args:
            data: The bytes, with their line ends.

        Raises:
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        self._refuse_conflict()
        self._client.write(data, self._host.now())
        self._host.wake(self._client)

    def write_line(self, text: str) -> None:
        """Send a line to the shell.

        Args:
            text: The line, without its end.

        Raises:
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        self._refuse_conflict()
        self._client.write_line(text, self._host.now())
        self._host.wake(self._client)

    def _refuse_conflict(self) -> None:
        if error := self._host.refusal_of(self._client.target, "writing to the shell of"):
            raise error

    async def __aenter__(self) -> Self:
        self._refuse_conflict()
        self._host.serve(self._client)
        self._client.open(self._host.now())
        self._host.wake(self._client)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._host.is_open:
                await self._release()
        finally:
            self._output.close()
            self._host.remove(self._client)

    async def _release(self) -> None:
        async with self._host.events(ShellReleased, of=self._client, queue=1) as released:
            self._client.close(self._host.now())
            self._host.wake(self._client)
            await anext(released, None)

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> str:
        return self._decoder.decode((await anext(self._output)).data)
