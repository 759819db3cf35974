"""Pseudo terminals: `pty:///tmp/ttyDrone` is a serial port of this machine for other programs; POSIX only.

The path is a symbolic link to the terminal, and is removed when the link closes. The one channel is there
from the beginning: a terminal does not tell whether a program has opened it.
"""

from __future__ import annotations

import asyncio
import errno
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.errors import LinkError
from mavstack.links.connection import ConnectionLink
from mavstack.links.os_errors import open_error
from mavstack.links.stream import DirectProtocol, StreamChannel

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.channel import Channel
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

#: The directory of pseudo terminals: a link into it that a killed program left behind is replaced.
_TERMINALS = "/dev/pts/"


def claim_terminal(descriptor: int) -> None:
    """Mark a terminal of this program as in use, so that no other program takes its names over.

    Args:
        descriptor: The descriptor of the terminal; the mark ends when it is closed.
    """
    # The mark is the sticky bit, not a lock: programs that open the terminal lock it themselves (pyserial,
    # stm32flash).
    with suppress(OSError):
        os.fchmod(descriptor, stat.S_IMODE(os.fstat(descriptor).st_mode) | stat.S_ISVTX)


def _is_claimed(terminal: str) -> bool:
    """Return whether a program that runs has made a terminal; a shell may have its number meanwhile."""
    with suppress(OSError):
        return bool(Path(terminal).stat().st_mode & stat.S_ISVTX)
    return False


def link_terminal(path: Path, terminal: str) -> None:
    """Give a terminal another name; a name that a killed program left is replaced.

    Args:
        path: The name, a symbolic link. Only a link to a pseudo terminal is replaced, and none of a program
            that runs (see `claim_terminal`).
        terminal: The terminal, such as `/dev/pts/3`.

    Raises:
        OSError: The name is used by something else, or cannot be made.
    """
    if path.is_symlink() and (known := str(path.readlink())).startswith(_TERMINALS):
        # The terminal of a program that ended may have got the same number.
        if known != terminal and _is_claimed(known):
            raise FileExistsError(errno.EEXIST, "another program that runs has this name", str(path))
        path.unlink()
    path.symlink_to(terminal)


def unlink_terminal(path: Path, terminal: str) -> None:
    """Remove the name of a terminal, unless another program has taken the name over. Idempotent.

    Args:
        path: The name.
        terminal: The terminal.
    """
    if path.is_symlink() and str(path.readlink()) == terminal:
        path.unlink(missing_ok=True)


class PseudoTerminalLink(ConnectionLink):
    """A link over one pseudo terminal."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._path = Path(url.path)
        self._descriptors: tuple[int, ...] = ()
        self._terminal = ""

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        try:
            import tty
        except ImportError as error:
            reason = "pseudo terminals exist only on Linux, macOS and other POSIX systems"
            raise LinkError(f"cannot open {self.url.redacted}: {reason}") from error
        try:
            # This link keeps the terminal open, so that the settings survive between two programs that use
            # it.
            self._descriptors = master, terminal = os.openpty()
            tty.setraw(terminal)
            claim_terminal(terminal)
            self._link_path(os.ttyname(terminal))
        except OSError as error:
            await self.release_transport()
            raise open_error(self.url, error) from error
        channel = await _channel(master, self.url, self.inbox.remove_channel, self._send_queue)
        self._add_channel(channel)
        self.spawn(self._serve_channel(channel))

    def _link_path(self, terminal: str) -> None:
        link_terminal(self._path, terminal)
        self._terminal = terminal

    async def _serve_channel(self, channel: TerminalChannel) -> None:
        await self._serve(channel)
        self.inbox.end()

    async def release_transport(self) -> None:
        """Release the remaining resources."""
        if self._terminal:
            unlink_terminal(self._path, self._terminal)
            self._terminal = ""
        for descriptor in self._descriptors:
            with suppress(OSError):
                os.close(descriptor)
        self._descriptors = ()


class TerminalChannel(StreamChannel):
    """A channel over the near end of a pseudo terminal."""

    def __init__(
        self,
        url: LinkURL,
        on_closed: Callable[[Channel, str], None],
        send_queue: int,
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter],
        read_transport: asyncio.ReadTransport,
    ) -> None:
        super().__init__(f"pty {url.path}", url.path, on_closed, streams, send_queue)
        self._read_transport = self._terminal = read_transport

    def close_transport(self) -> None:
        """Start closing the transport."""
        super().close_transport()
        self._terminal.close()


async def _channel(
    master: int, url: LinkURL, on_closed: Callable[[Channel, str], None], send_queue: int
) -> TerminalChannel:
    """Register the near end of a terminal with the event loop, by a descriptor for each direction."""
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader()
    read_transport, _ = await loop.connect_read_pipe(
        lambda: DirectProtocol(reader), os.fdopen(os.dup(master), "rb", buffering=0)
    )
    write_transport, protocol = await loop.connect_write_pipe(
        lambda: asyncio.StreamReaderProtocol(asyncio.StreamReader()),
        os.fdopen(os.dup(master), "wb", buffering=0),
    )
    writer = asyncio.StreamWriter(write_transport, protocol, None, loop)
    return TerminalChannel(url, on_closed, send_queue, (reader, writer), read_transport)
