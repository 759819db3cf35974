"""The asyncio driver of an AT session: a link to a SiK radio, by cable or over a serial server.

    async with SikModem("serial:///dev/ttyUSB0?baud=57600") as modem:
        radio = SikRadio(modem)
        print(await radio.get_identity())

The radio passes bytes again when the block ends, also after an error or Ctrl-C.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Self

from mavstack.errors import InvalidStateError, LinkError, RadioError
from mavstack.links import Link, open_link, parse_url
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown
from mavstack.radio.session import AtCommand, AtSession, Reply

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    from mavstack.links import Channel, LinkEvent, LinkURL
    from mavstack.radio.replies import RssiReport

#: Seconds until a radio that restarts accepts bytes again.
BOOT_TIME: Final = 1.5
#: Seconds to wait for a signal report; the radio prints one each second.
REPORT_TIMEOUT: Final = 2.0
#: Seconds to wait for the channel of a link that opens.
CHANNEL_TIMEOUT: Final = 5.0


class SikModem:
    """A link to a SiK radio, and the AT session over it; an async context manager.

    Args:
        link: The link, or its URL; the modem opens and closes it.
    """

    def __init__(self, link: str | Link) -> None:
        self._link = link if isinstance(link, Link) else open_link(link)
        self._loop = asyncio.get_running_loop()
        self._session = AtSession(self._loop.time())
        self._channel: Channel | None = None
        self._failure: str | None = None
        self._wake = asyncio.Event()
        self._reader: asyncio.Task[None] | None = None

    @property
    def url(self) -> LinkURL:
        """The URL of the link."""
        return self._link.url

    async def open(self) -> Self:
        """Open the link.

        Returns:
            The modem itself.

        Raises:
            LinkError: The link cannot be opened, or has no peer.
        """
        await self._link.open()
        self._reader = self._loop.create_task(self._link.read(self._receive))
        try:
            async with asyncio.timeout(CHANNEL_TIMEOUT):
                while self._channel is None and self._failure is None:
                    await self._wait()
        except TimeoutError:
            self._failure = "nothing is connected"
        if self._channel is None:
            await self.close()
            raise LinkError(f"cannot open {self.url.redacted}: {self._failure}")
        return self

    async def close(self) -> None:
        """Let the radio pass bytes again, and close the link. Idempotent."""
        if self._channel is not None and self._failure is None:
            with suppress(RadioError, LinkError):
                await self.leave()
                await self._channel.drain()
        await self._link.close()
        if self._reader is not None:
            self._reader.cancel()
            await asyncio.gather(self._reader, return_exceptions=True)
        self._channel = None

    async def enter(self) -> None:
        """Enter command mode; has no effect in command mode.

        Raises:
            RadioError: The radio does not answer.
        """
        self._session.enter(self._loop.time())
        try:
            await self._finish()
        except RadioError as error:
            raise RadioError(f"{self.url.redacted}: {error}") from None

    async def leave(self) -> None:
        """Return to passing bytes.

        Raises:
            RadioError: The link was lost.
        """
        self._session.leave(self._loop.time())
        await self._finish()

    async def run(self, command: AtCommand) -> tuple[str, ...]:
        """Run a command, in command mode.

        Returns:
            The lines of the reply.

        Raises:
            RadioError: The radio does not answer, or refuses the command.
        """
        await self.enter()
        self._session.start(command, self._loop.time())
        return await self._finish()

    async def wait_for_reports(self) -> list[RssiReport]:
        """Wait for reports of the signal that the radio prints by itself, at most `REPORT_TIMEOUT`.

        Returns:
            The reports since the last call; empty if none came in time.

        Raises:
            RadioError: The link was lost.
        """
        with suppress(TimeoutError):
            async with asyncio.timeout(REPORT_TIMEOUT):
                while not (reports := self._session.reports()):
                    self._flush()  # raises if the link was lost
                    await self._wait()
                return reports
        return []

    async def restart(self, *, baud: int | None = None) -> None:
        """Restart the radio with its stored parameters, and wait until it takes bytes.

        Args:
            baud: Baud rate of a serial port after the restart; None for the present one.

        Raises:
            RadioError: The radio does not answer.
            LinkError: The port cannot be opened at the rate.
        """
        await self.run(AtCommand("ATZ", Reply.NONE, attempts=1))
        self.assume_restarted()
        await asyncio.sleep(BOOT_TIME)
        if baud is not None and self.url.scheme == "serial":
            await self._open_again(baud)

    def assume_restarted(self) -> None:
        """Note that the radio has left command mode by a restart, such as that of its boot loader."""
        self._session.assume_transparent(self._loop.time())

    async def _open_again(self, baud: int) -> None:
        url = replace(self.url, options={**self.url.options, "baud": str(baud)})
        await self.close()
        self._link, self._failure = open_link(str(url)), None
        self._session = AtSession(self._loop.time())
        await self.open()

    async def _finish(self) -> tuple[str, ...]:
        """Drive the session to the end of its operation."""
        session = self._session
        while True:
            session.handle_timeout(self._loop.time())
            self._flush()
            if session.done:
                return session.result()
            deadline = session.next_timeout()
            if deadline is None:
                raise InvalidStateError("the session waits for nothing")
            with suppress(TimeoutError):
                async with asyncio.timeout_at(deadline):
                    await self._wait()

    async def _wait(self) -> None:
        await self._wake.wait()
        self._wake.clear()

    def _flush(self) -> None:
        data = self._session.data_to_send()
        if self._failure is not None or self._channel is None:
            raise RadioError(f"{self.url.redacted}: the link was lost: {self._failure}")
        if data:
            self._channel.write(data)

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            self._receive_event(event)
        self._wake.set()

    def _receive_event(self, event: LinkEvent) -> None:
        match event:
            case ChannelOpened(channel) if self._channel is None:
                self._channel, self._failure = channel, None
            case BytesReceived(channel, data, _) if channel is self._channel:
                self._session.receive(data, self._loop.time())
            case ChannelClosed(channel, reason) if channel is self._channel:
                self._failure = reason
            case LinkDown(reason, _) if self._channel is None:
                self._failure = reason

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        await self.close()


def radio_url(text: str, baud: int | None = None) -> str:
    """Return the URL of a radio.

    Args:
        text: A URL, or the path of a serial device.
        baud: Baud rate of a serial device; None for that of the URL, or 57600.

    Returns:
        The URL.

    Raises:
        LinkURLError: The URL is malformed.
    """
    url = parse_url(text)
    if url.scheme == "file":  # a device name, such as a symbolic link to a port
        url = replace(url, scheme="serial")
    if baud is not None:
        url = replace(url, options={**url.options, "baud": str(baud)})
    return str(url)
