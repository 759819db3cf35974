"""Serial ports: `serial:///dev/ttyACM0?baud=57600`, `serial://COM3`; needs the extra `serial`.

The port is taken for this program alone, opened with 8 data bits, no parity and one stop bit, and with
`flow=rtscts` or `flow=xonxoff` if asked. When the device is unplugged the link goes down and opens it again
as soon as it is back. On POSIX the file descriptor is read by the event loop itself; on Windows, whose
event loop cannot, by a thread (`threads=yes` does so anywhere).
"""

from __future__ import annotations

import asyncio
import errno
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import LinkError, MissingExtraError
from mavstack.links.connection import ClientLink, Connection
from mavstack.links.explain import explain
from mavstack.links.queued import QueuedConnection
from mavstack.links.stream import StreamConnection

if TYPE_CHECKING:
    from collections.abc import Callable

    from serial import Serial

    from mavstack.links.channel import Channel
    from mavstack.links.inbox import Inbox
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

BAUD = 57600  # what telemetry radios and MAVProxy use; USB ports ignore it
_READ_TIMEOUT = 0.1


class SerialLink(ClientLink):
    """One serial port; its only channel lives as long as the device is there."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._baud = options.whole("baud", BAUD)
        self._flow = options.choice("flow", ("none", "rtscts", "xonxoff"))
        self._threads = options.flag("threads", default=sys.platform == "win32")

    async def _connect(self) -> Connection:
        port = self._open_port()
        name = f"serial {self.url.path}"
        if self._threads:
            return ThreadedSerial(name, self.url.path, self._inbox.closed, self._send_queue, port)
        try:
            return await _watch(port, name, self._inbox.closed, self._send_queue)
        except BaseException:
            port.close()
            raise

    def _open_port(self) -> Serial:
        try:
            import serial
        except ImportError as error:
            raise MissingExtraError("a serial link", "serial") from error
        try:
            return serial.Serial(
                self.url.path,
                self._baud,
                exclusive=True,
                rtscts=self._flow == "rtscts",
                xonxoff=self._flow == "xonxoff",
                timeout=_READ_TIMEOUT,
            )
        except (serial.SerialException, OSError, ValueError) as error:
            raise self._explain(error) from error

    def _explain(self, error: Exception) -> LinkError:
        """Find out what pyserial hides: it wraps errors, on Windows in text only."""
        code, text = getattr(error, "errno", None), str(error)
        if code == errno.ENOENT or "FileNotFoundError" in text:
            return LinkError(f"cannot open {self.url}: there is no such device: {self.url.path}; {_found()}")
        if code in (errno.EBUSY, errno.EAGAIN) or "PermissionError" in text:
            return explain(self.url, OSError(errno.EBUSY, text))
        if code == errno.EACCES:
            hint = "add yourself to the group that owns it (dialout or uucp) and log in again"
            return LinkError(f"cannot open {self.url}: no permission for {self.url.path}: {hint}")
        if "configure port" in text or isinstance(error, ValueError):
            return LinkError(
                f"cannot open {self.url}: not a serial port, or it has no baud rate {self._baud}: {text}"
            )
        return explain(self.url, OSError(code or 0, text))


def _found() -> str:
    """The serial ports that this machine has, for an error's text."""
    from serial.tools.list_ports import comports

    names = ", ".join(sorted(port.device for port in comports()))
    return f"this machine has {names}" if names else "this machine has no serial ports now: is it plugged in?"


async def _watch(
    port: Serial, name: str, gone: Callable[[Channel, str], None], send_queue: int
) -> PosixSerial:
    """Let the event loop read and write the port, by a descriptor for each direction."""
    _block_for_one_byte(port.fileno())
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader()
    reading, _ = await loop.connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(os.dup(port.fileno()), "rb", buffering=0)
    )
    writing, protocol = await loop.connect_write_pipe(
        lambda: asyncio.StreamReaderProtocol(asyncio.StreamReader()),
        os.fdopen(os.dup(port.fileno()), "wb", buffering=0),
    )
    writer = asyncio.StreamWriter(writing, protocol, None, loop)
    return PosixSerial(name, gone, (reader, writer), send_queue, (reading, port))


def _block_for_one_byte(descriptor: int) -> None:
    """Make a read without data fail with EAGAIN; as pyserial sets it up it would look like the end."""
    import termios

    settings = termios.tcgetattr(descriptor)
    settings[6][termios.VMIN] = 1
    termios.tcsetattr(descriptor, termios.TCSANOW, settings)


class PosixSerial(StreamConnection):
    """A serial port read and written by the event loop."""

    def __init__(
        self,
        name: str,
        gone: Callable[[Channel, str], None],
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter],
        send_queue: int,
        owned: tuple[asyncio.ReadTransport, Serial],
    ) -> None:
        super().__init__(name, str(owned[1].port), gone, streams, send_queue)
        self._reading, self._port = owned

    def _shut(self) -> None:
        super()._shut()
        self._reading.close()
        with suppress(OSError):
            self._port.close()


class ThreadedSerial(QueuedConnection):
    """A serial port read and written by two threads."""

    def __init__(
        self, name: str, peer: str, gone: Callable[[Channel, str], None], send_queue: int, port: Serial
    ) -> None:
        super().__init__(name, peer, gone, send_queue)
        self._port = port
        self._threads = ThreadPoolExecutor(2, thread_name_prefix=name)
        self._hung_up = False

    def abort(self) -> None:
        """Close the port under the threads, which then end."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        with suppress(OSError):
            self._port.close()

    async def _receive_all(self, inbox: Inbox) -> str:
        loop = asyncio.get_running_loop()
        try:
            while not self._hung_up:
                data = await loop.run_in_executor(self._threads, self._read)
                if data and not self.closed:
                    inbox.put(self, data, time())
                    await inbox.room()
        except OSError as error:
            return error.strerror or str(error)
        return "closed by the peer"

    def _read(self) -> bytes:
        """Wait for a byte, and take what came with it."""
        first: bytes = self._port.read(1)
        return first + self._port.read(self._port.in_waiting) if first else first

    async def _transmit(self, data: bytes) -> None:
        await asyncio.get_running_loop().run_in_executor(self._threads, self._port.write, data)

    async def _hang_up(self) -> None:
        self._hung_up = True
        with suppress(OSError):
            self._port.cancel_read()
