"""A source of corrections that runs: a caster, or a base at a link, with reconnects.

A caster that refuses the password, or does not know the mountpoint, ends the feed with its error. Everything
else is repeated with growing pauses: networks in the field come and go.
"""

from __future__ import annotations

import asyncio
import logging
import ssl
from enum import StrEnum
from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkError
from mavstack.gnss import CasterError, NtripClient, NtripURL, SourceTableEntry
from mavstack.gnss.ublox import SurveyState, UbxFramer, base_configuration
from mavstack.links import open_link
from mavstack.links.events import BytesReceived, ChannelOpened, LinkDown
from mavstack.node.api_object import ApiObject

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.gnss.ublox import FixedPosition, SurveyIn
    from mavstack.links.events import LinkEvent

_LOG = logging.getLogger("mavstack.vehicle.rtk")

CONNECT_TIMEOUT: Final = 10.0
#: Seconds without a byte after which a caster is requested again.
SILENCE_TIMEOUT: Final = 30.0
#: Seconds between two attempts: the first pause, and the longest.
MIN_PAUSE: Final = 1.0
MAX_PAUSE: Final = 30.0
_CHUNK: Final = 65_536


class FeedState(StrEnum):
    """The state of a source."""

    CONNECTING = "connecting"
    STREAMING = "streaming"
    WAITING = "waiting"
    ENDED = "ended"


class CorrectionFeed(ApiObject):
    """A source of corrections; `vehicle.rtk.corrections` makes it, `async with` runs it.

    Attributes:
        url: The URL of the source, without password.
        state: Whether it streams, connects, or waits for the next attempt.
        problem: The reason for the last loss of the connection; empty if there was none.
        connects: How often the source began to stream.
        survey: The progress of a base's survey; None if it has none.
    """

    def __init__(
        self,
        url: str,
        deliver: Callable[[bytes], object],
        gga: Callable[[], bytes] = bytes,
        *,
        base: SurveyIn | FixedPosition | None = None,
    ) -> None:
        self._caster = NtripURL.parse(url) if url.startswith(("ntrip://", "ntrips://")) else None
        self._link_url = url
        self._configuration = b"" if base is None else base_configuration(base)
        if self._caster is None:
            self.url = open_link(url).url.redacted
        else:
            self.url = str(self._caster)
        self.state = FeedState.CONNECTING
        self.problem = ""
        self.connects = 0
        self.survey: SurveyState | None = None
        self._deliver, self._gga = deliver, gga
        self._ubx = UbxFramer()
        self._task: asyncio.Task[None] | None = None
        #: Called when the state changes.
        self.on_change: Callable[[CorrectionFeed], object] = lambda feed: None

    async def __aenter__(self) -> Self:
        self._task = asyncio.get_running_loop().create_task(self.run())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    async def wait(self) -> None:
        """Wait until the source ends, which it does only by an error.

        Raises:
            LinkError: The caster refuses the request permanently.
        """
        if self._task is not None:
            await asyncio.shield(self._task)

    async def run(self) -> None:
        """Run the source until it is cancelled.

        Raises:
            LinkError: The caster refuses the request permanently, or the link cannot be opened.
        """
        try:
            if self._caster is None:
                await self._run_link()
            else:
                await self._run_caster(self._caster)
        finally:
            self._change(FeedState.ENDED)

    async def _run_caster(self, url: NtripURL) -> None:
        pause = MIN_PAUSE
        while True:
            self._change(FeedState.CONNECTING)
            connects = self.connects
            try:
                await self._session(url)
                self.problem = "the caster closed the connection"
            except CasterError as error:
                self.problem = str(error)
                if error.permanent:
                    raise
            except TimeoutError:
                self.problem = "no data"
            except OSError as error:
                self.problem = error.strerror or str(error)
            pause = MIN_PAUSE if self.connects > connects else min(pause * 2, MAX_PAUSE)
            _LOG.warning("%s: %s; next attempt in %g s", self.url, self.problem, pause)
            self._change(FeedState.WAITING)
            await asyncio.sleep(pause)

    async def _session(self, url: NtripURL) -> None:
        """Stream corrections until the connection ends."""
        reader, writer = await _connect(url)
        sender: asyncio.Task[None] | None = None
        client = NtripClient(url)
        try:
            writer.write(client.request(self._gga() if url.gga_interval else b""))
            while data := await asyncio.wait_for(reader.read(_CHUNK), SILENCE_TIMEOUT):
                corrections = client.feed(data)
                if client.is_streaming and sender is None:
                    self.connects += 1
                    self._change(FeedState.STREAMING)
                    sender = asyncio.get_running_loop().create_task(self._send_gga(url, writer))
                if corrections:
                    self._deliver(corrections)
        finally:
            if sender is not None:
                sender.cancel()
                await asyncio.gather(sender, return_exceptions=True)
            writer.close()

    async def _send_gga(self, url: NtripURL, writer: asyncio.StreamWriter) -> None:
        while url.gga_interval:
            sentence = self._gga()
            if sentence:
                writer.write(sentence)
            await asyncio.sleep(url.gga_interval if sentence else 1.0)

    async def _run_link(self) -> None:
        async with open_link(self._link_url) as link:
            await link.read(self._receive)
        raise LinkError(f"{self.url}: the link ended")

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case ChannelOpened(channel):
                    self.connects += 1
                    if self._configuration:
                        channel.write(self._configuration)
                    self._change(FeedState.STREAMING)
                case LinkDown(reason=reason):
                    self.problem = reason
                    self._change(FeedState.WAITING)
                case BytesReceived(data=data):
                    for state in self._ubx.feed(data) if self._configuration else ():
                        self.survey = state
                    self._deliver(data)

    def _change(self, state: FeedState) -> None:
        if state != self.state:
            self.state = state
            self.on_change(self)


async def download_source_table(url: str, *, timeout: float | None = 15.0) -> list[SourceTableEntry]:
    """Download the source table of a caster.

    Args:
        url: The URL of the caster; its mountpoint does not matter.
        timeout: Seconds for the whole call; None: until the caster ends the connection.

    Returns:
        The streams of the caster.

    Raises:
        LinkError: The caster cannot be reached, does not answer in time, or refuses the request.
    """
    parsed = NtripURL.parse(url)
    caster = NtripURL(
        parsed.host, parsed.port, "", parsed.user, parsed.password, parsed.tls, parsed.version, 0.0
    )
    client = NtripClient(caster)
    try:
        async with asyncio.timeout(timeout):
            await _read_table(caster, client)
    except TimeoutError:
        raise LinkError(f"opening {caster} failed: no answer") from None
    except OSError as error:
        raise LinkError(f"opening {caster} failed: {error.strerror or error}") from None
    if client.source_table is None:
        raise LinkError(f"opening {caster} failed: it sent no source table")
    return client.source_table


async def _read_table(caster: NtripURL, client: NtripClient) -> None:
    reader, writer = await _connect(caster)
    try:
        writer.write(client.request())
        while client.source_table is None and not client.is_streaming:
            data = await reader.read(_CHUNK)
            if not data:
                client.end()
                return
            client.feed(data)
    finally:
        writer.close()


async def _connect(url: NtripURL) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    context = ssl.create_default_context() if url.tls else None
    async with asyncio.timeout(CONNECT_TIMEOUT):
        return await asyncio.open_connection(url.host, url.port, ssl=context)
