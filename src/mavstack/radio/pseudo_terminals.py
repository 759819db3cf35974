"""A simulated pair of radios on two pseudo terminals, which programs open like serial ports; POSIX only."""

from __future__ import annotations

import asyncio
import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Self

from mavstack.errors import LinkError
from mavstack.links.pseudo_terminal import claim_terminal, link_terminal, unlink_terminal
from mavstack.radio.simulator import RadioPair

if TYPE_CHECKING:
    from collections.abc import Callable

_CHUNK = 4096


class PairDriver:
    """The clock of a simulated pair, and the ways for the bytes of both radios.

    Args:
        pair: The pair.
        writers: Called with the bytes of the near and of the far radio.
    """

    def __init__(self, pair: RadioPair, *writers: Callable[[bytes], object]) -> None:
        self._pair, self._writers = pair, writers
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None

    def receive(self, index: int, data: bytes) -> None:
        """Process bytes of the program at the near (0) or far (1) radio."""
        self._pair.receive(index, data, self._loop.time())
        self._flush()

    def close(self) -> None:
        """Stop the clock."""
        if self._timer is not None:
            self._timer.cancel()

    def _advance(self) -> None:
        self._pair.advance(self._loop.time())
        self._flush()

    def _flush(self) -> None:
        for index, write in enumerate(self._writers):
            if data := self._pair.output(index):
                write(data)
        self.close()
        due = self._pair.next_timeout()
        self._timer = None if due is None else self._loop.call_at(due, self._advance)


class RadioTerminals:
    """A simulated pair of radios on two terminals; an async context manager.

    Attributes:
        pair: The radios.
        devices: Paths of the near and of the far terminal.
    """

    def __init__(self, pair: RadioPair | None = None) -> None:
        self.pair = pair or RadioPair()
        self.devices: tuple[str, ...] = ()
        self._descriptors: list[int] = []
        self._links: list[tuple[Path, str]] = []
        self._driver: PairDriver | None = None

    def link(self, index: int, path: str | os.PathLike[str]) -> None:
        """Give a terminal another name, a symbolic link that is removed at the end.

        Args:
            index: 0 for the near radio, 1 for the far one.
            path: The name; it must not exist, unless a killed program left it.

        Raises:
            OSError: The name exists, or cannot be made.
        """
        name = Path(path)
        try:
            link_terminal(name, self.devices[index])
        except OSError as error:  # show the requested name in the error
            raise OSError(error.errno, error.strerror, str(path)) from None
        self._links.append((name, self.devices[index]))

    async def __aenter__(self) -> Self:
        try:
            import tty
        except ImportError as error:
            raise LinkError(
                "simulated radios need pseudo terminals, which this system does not have"
            ) from error
        loop = asyncio.get_running_loop()
        masters = []
        for _ in range(2):
            master, terminal = os.openpty()
            tty.setraw(terminal)
            claim_terminal(terminal)
            os.set_blocking(master, False)
            self.devices += (os.ttyname(terminal),)
            self._descriptors += [
                master,
                terminal,
            ]  # an open terminal keeps its settings until the next program opens it
            masters.append(master)
        self._driver = PairDriver(self.pair, *(_writer(master) for master in masters))
        for index, master in enumerate(masters):
            loop.add_reader(master, self._read, index, master)
        return self

    async def __aexit__(self, *_: object) -> None:
        loop = asyncio.get_running_loop()
        if self._driver is not None:
            self._driver.close()
        for descriptor in self._descriptors:
            loop.remove_reader(descriptor)
            os.close(descriptor)
        for name, device in self._links:
            unlink_terminal(name, device)

    def _read(self, index: int, master: int) -> None:
        with suppress(BlockingIOError):
            data = os.read(master, _CHUNK)
            if self._driver is not None:
                self._driver.receive(index, data)


def _writer(master: int) -> Callable[[bytes], object]:
    """Return a function that writes to a terminal; what no program reads is lost, as on a cable."""

    def write(data: bytes) -> None:
        with suppress(BlockingIOError):
            os.write(master, data)

    return write
