"""A simulated Iridium modem on a pseudo terminal, which programs open like a serial port; POSIX only."""

from __future__ import annotations

import asyncio
import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Self

from mavstack.errors import LinkError
from mavstack.links.pseudo_terminal import link_terminal, unlink_terminal
from mavstack.radio.sbd_simulator import SESSION_TIME, SimulatedSbdModem

if TYPE_CHECKING:
    from types import TracebackType

_CHUNK = 4096


class SbdTerminal:
    """A modem on a terminal; an async context manager.

    Attributes:
        modem: The modem.
        device: The path of the terminal.
    """

    def __init__(self, *, session_time: float = SESSION_TIME) -> None:
        self.modem = SimulatedSbdModem(session_time)
        self.device = ""
        self._descriptors: list[int] = []
        self._links: list[tuple[Path, str]] = []
        self._timer: asyncio.TimerHandle | None = None

    def link(self, path: str | os.PathLike[str]) -> None:
        """Give the terminal another name, a symbolic link that is removed at the end.

        Raises:
            OSError: The name exists, or cannot be made.
        """
        link_terminal(Path(path), self.device)
        self._links.append((Path(path), self.device))

    def deliver(self, message: bytes) -> None:
        """Put a message into the mailbox of the modem, and ring."""
        self.modem.deliver(message)
        self._flush()

    async def __aenter__(self) -> Self:
        try:
            import tty
        except ImportError:
            raise LinkError("a simulated modem needs pseudo terminals, which Windows lacks") from None
        own, other = os.openpty()
        self._descriptors = [own, other]
        tty.setraw(other)
        self.device = os.ttyname(other)
        os.set_blocking(own, False)
        asyncio.get_running_loop().add_reader(own, self._read)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        asyncio.get_running_loop().remove_reader(self._descriptors[0])
        if self._timer is not None:
            self._timer.cancel()
        for path, device in self._links:
            unlink_terminal(path, device)
        for descriptor in self._descriptors:
            os.close(descriptor)

    def _read(self) -> None:
        with suppress(BlockingIOError):
            data = os.read(self._descriptors[0], _CHUNK)
            self.modem.receive(data, asyncio.get_running_loop().time())
            self._flush()

    def _flush(self) -> None:
        if data := self.modem.output():
            with suppress(BlockingIOError):
                os.write(self._descriptors[0], data)
        if self._timer is not None:
            self._timer.cancel()
        due = self.modem.next_timeout()
        loop = asyncio.get_running_loop()
        self._timer = None if due is None else loop.call_at(due, self._advance)

    def _advance(self) -> None:
        self.modem.advance(asyncio.get_running_loop().time())
        self._flush()
