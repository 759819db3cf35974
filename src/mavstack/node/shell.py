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
from mavstack.node.serial_port import SerialPort
from mavstack.services.serial_control import ShellClient

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.node.host import NodeHost
    from mavstack.services import Address


class Shell(ReadOnly):
    """A shell: write commands to it, and iterate over its output as text; an async context manager."""

    def __init__(self, host: NodeHost, address: Address) -> None:
        self._port = SerialPort(host, ShellClient(host.address, address), "writing to the shell of")
        self._decoder = getincrementaldecoder("utf-8")("replace")

    def write(self, data: bytes) -> None:
        """Send bytes to the shell.

        Args:
            data: The bytes, with their line ends.

        Raises:
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        self._port.write(data)

    def write_line(self, text: str) -> None:
        """Send a line to the shell.

        Args:
            text: The line, without its end.

        Raises:
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        self._port.write(text.encode() + b"\n")

    async def __aenter__(self) -> Self:
        await self._port.__aenter__()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._port.__aexit__(kind, error, trace)

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> str:
        return self._decoder.decode(await anext(self._port))
