"""Serial ports: `serial:///dev/ttyACM0?baud=57600`, `serial://COM3`; needs the extra `serial`.

The port is opened exclusively, with 8 data bits, no parity and one stop bit; `flow=rtscts` or `flow=xonxoff`
enable flow control. When the device is unplugged the link goes down, and reopens the device when it is
plugged in again. On POSIX the event loop reads the file descriptor; on Windows, where it cannot, a thread
does (`threads=yes` uses threads on every system).
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
from mavstack.links.connection import ClientLink, ConnectionChannel
from mavstack.links.os_errors import open_error
from mavstack.links.queued import QueuedChannel
from mavstack.links.stream import DirectProtocol, StreamChannel

if TYPE_CHECKING:
    from collections.abc import Callable

    from serial import Serial

    from mavstack.links.channel import Channel
    from mavstack.links.inbox import Inbox
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

DEFAULT_BAUD = 57600  # the rate of telemetry radios and MAVProxy; USB ports ignore it
_READ_TIMEOUT = 0.1


class SerialLink(ClientLink):
    """A link over one serial port; its channel closes when the device is unplugged."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._baud = options.integer("baud", DEFAULT_BAUD)
        self._flow = options.choice("flow", ("none", "rtscts", "xonxoff"))
        self._threads = options.flag("threads", default=sys.platform == "win32")

    @property
    def baud(self) -> int:
        """Rate of the line in bits per second."""
        return self._baud

    async def _connect(self) -> ConnectionChannel:
        port = self.open_port()
        name = f"serial {self.url.path}"
        if self._threads:
            return ThreadedSerialChannel(
                name, self.url.path, self.inbox.remove_channel, self._send_queue, port
            )
        try:
            return await _open_posix(port, name, self.inbox.remove_channel, self._send_queue)
        except BaseException:
            port.close()
            raise

    def open_port(self) -> Serial:
        """Open the port alone, for a program that reads it itself.

        Raises:
            LinkError: The port cannot be opened.
            MissingExtraError: pyserial is not installed.
        """
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
            raise self._open_error(error) from error

    def _open_error(self, error: Exception) -> LinkError:
        """Convert an error of pyserial, which wraps the system's error, on Windows as text only."""
        code, text = getattr(error, "errno", None), str(error)
        if code == errno.ENOENT or "FileNotFoundError" in text:
            return LinkError(
                f"cannot open {self.url.redacted}: no such device: {self.url.path}; {_available_ports()}"
            )
        if code in (errno.EBUSY, errno.EAGAIN) or "PermissionError" in text:
            return open_error(self.url, OSError(errno.EBUSY, text))
        if code == errno.EACCES:
            hint = "add yourself to the group that owns it (dialout or uucp) and log in again"
            return LinkError(f"cannot open {self.url.redacted}: no permission for {self.url.path}: {hint}")
        if "configure port" in text or isinstance(error, ValueError):
            return LinkError(
                f"cannot open {self.url.redacted}: not a serial port, or it does not support "
                f"{self._baud} baud: {text}"
            )
        return open_error(self.url, OSError(code or 0, text))


def _available_ports() -> str:
    """Return the serial ports of this machine as a sentence for an error text."""
    from serial.tools.list_ports import comports

    names = ", ".join(sorted(port.device for port in comports()))
    return (
        f"this machine has {names}"
        if names
        else "this machine has no serial ports now: check that the device is plugged in"
    )


async def _open_posix(
    port: Serial, name: str, on_closed: Callable[[Channel, str], None], send_queue: int
) -> PosixSerialChannel:
    """Register the port with the event loop, by a descriptor for each direction."""
    block_for_one_byte(port.fileno())
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader()
    read_transport, _ = await loop.connect_read_pipe(
        lambda: DirectProtocol(reader), os.fdopen(os.dup(port.fileno()), "rb", buffering=0)
    )
    write_transport, protocol = await loop.connect_write_pipe(
        lambda: asyncio.StreamReaderProtocol(asyncio.StreamReader()),
        os.fdopen(os.dup(port.fileno()), "wb", buffering=0),
    )
    writer = asyncio.StreamWriter(write_transport, protocol, None, loop)
    return PosixSerialChannel(name, on_closed, (reader, writer), send_queue, (read_transport, port))


def block_for_one_byte(descriptor: int) -> None:
    """Make a read without data fail with EAGAIN; with pyserial's settings it returns end of file."""
    import termios

    settings = termios.tcgetattr(descriptor)
    settings[6][termios.VMIN] = 1
    termios.tcsetattr(descriptor, termios.TCSANOW, settings)


class PosixSerialChannel(StreamChannel):
    """A channel over a serial port, read and written by the event loop."""

    def __init__(
        self,
        name: str,
        on_closed: Callable[[Channel, str], None],
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter],
        send_queue: int,
        resources: tuple[asyncio.ReadTransport, Serial],
    ) -> None:
        super().__init__(name, str(resources[1].port), on_closed, streams, send_queue)
        self._terminal, self._port = resources
        self._read_transport = self._terminal

    def close_transport(self) -> None:
        """Start closing the transport."""
        super().close_transport()
        self._terminal.close()
        with suppress(OSError):
            self._port.close()

    def abort(self) -> None:
        """Close the transport without sending its buffer."""
        # A transport of a pipe without a buffer ends by itself; asyncio would end it a second time, and fail.
        if self._writer.transport.get_write_buffer_size():
            super().abort()


class ThreadedSerialChannel(QueuedChannel):
    """A channel over a serial port, read and written by two threads."""

    def __init__(
        self, name: str, peer: str, on_closed: Callable[[Channel, str], None], send_queue: int, port: Serial
    ) -> None:
        super().__init__(name, peer, on_closed, send_queue)
        self._port = port
        self._threads = ThreadPoolExecutor(2, thread_name_prefix=name)
        self._disconnected = False

    def abort(self) -> None:
        """Close the port, which also ends the threads."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        with suppress(OSError):
            self._port.close()

    async def _receive_loop(self, inbox: Inbox) -> str:
        loop = asyncio.get_running_loop()
        try:
            while not self._disconnected:
                data = await loop.run_in_executor(self._threads, self._read)
                if data and not self.closed:
                    inbox.put(self, data, time())
                    await inbox.wait_for_room()
        except OSError as error:
            return error.strerror or str(error)
        return "closed by the peer"

    def _read(self) -> bytes:
        """Wait for a byte, and read all bytes available after it."""
        first: bytes = self._port.read(1)
        return first + self._port.read(self._port.in_waiting) if first else first

    async def _transmit(self, data: bytes) -> None:
        await asyncio.get_running_loop().run_in_executor(self._threads, self._port.write, data)

    async def _disconnect(self) -> None:
        self._disconnected = True
        with suppress(OSError):
            self._port.cancel_read()
