"""Replay links: `file://flight.tlog?speed=2`; `speed=max` (or 0) replays as fast as the events are read.

A tlog is replayed without its timestamps, which become the times of the events: a live link does not transmit
them, and a parser could take one for the start of a packet. Packets within a few milliseconds are one chunk.
Pauses of more than a minute are shortened, so that a log in which the clock was set replays without waiting
for years. Any other file has no timestamps and is replayed as fast as it is read. The link ends with the
file; bytes written to its channel are dropped.
"""

from __future__ import annotations

import asyncio
import stat
from pathlib import Path
from time import time
from typing import TYPE_CHECKING, BinaryIO

from mavstack.errors import LinkError, LinkURLError
from mavstack.links.base import Link
from mavstack.links.channel import Channel, Data
from mavstack.links.os_errors import open_error
from mavstack.links.tlog import TlogScanner, looks_like_tlog
from mavstack.wire.other_formats import MAX_MAGIC_LENGTH, other_format

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.links.options import Options
    from mavstack.links.tlog import TimedPacket
    from mavstack.links.url import LinkURL

CHUNK = 1 << 17
MAX_CHUNK_SPAN = 0.005  # seconds within which recorded packets are joined to one chunk
MAX_SILENCE = 60.0  # seconds to which longer pauses of a recording are shortened


class FileChannel(Channel):
    """The recorded peer; written bytes are dropped."""

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        return False

    def close_transport(self) -> None:
        """Start closing the transport."""


class FileLink(Link):
    """A link that replays one file."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._speed = (
            0.0 if options.text("speed", "1") == "max" else self._parse_speed(options.text("speed", "1"))
        )
        self._path = Path(url.path).expanduser()

    def _parse_speed(self, text: str) -> float:
        try:
            speed = float(text)
        except ValueError:
            speed = -1.0
        if not 0 <= speed < float("inf"):
            raise LinkURLError(
                f"{self.url.redacted}: the option speed={text} must be a number such as 1 or 10, or max"
            )
        return speed

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        try:
            mode = self._path.stat().st_mode
            if stat.S_ISCHR(mode):
                raise LinkError(f"cannot open {self.url.redacted}: it is a device: use serial://{self._path}")
            if stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode):
                raise LinkError(f"cannot open {self.url.redacted}: it is not a regular file")
            file = self._path.open("rb")
            other = other_format(file.peek(MAX_MAGIC_LENGTH))
        except OSError as error:
            raise open_error(self.url, error) from error
        if other is not None:
            file.close()
            raise LinkError(
                f"cannot open {self.url.redacted}: this is {other}, not a stream of MAVLink packets"
            )
        channel = FileChannel(f"file {self._path.name}", str(self._path), self.inbox.remove_channel)
        self.inbox.add_channel(channel)
        self.spawn(self._replay(channel, file))

    async def _replay(self, channel: Channel, file: BinaryIO) -> None:
        with file:
            if looks_like_tlog(file.read(CHUNK)):
                file.seek(0)
                await self._replay_timed(channel, self._chunks(file))
            else:
                file.seek(0)
                await self._replay_plain(channel, file)
        channel.close("end of file")
        self.inbox.end()

    async def _replay_plain(self, channel: Channel, file: BinaryIO) -> None:
        while (data := file.read(CHUNK)) and not channel.closed:
            self.inbox.put(channel, data, time())
            await self._wait_for_reader()

    async def _replay_timed(self, channel: Channel, groups: Iterable[TimedPacket]) -> None:
        clock = ReplayClock(self._speed, asyncio.get_running_loop().time())
        for recorded, data in groups:
            due = clock.due(recorded)
            await asyncio.sleep(due - asyncio.get_running_loop().time())
            if channel.closed:
                return
            self.inbox.put(channel, data, recorded)
            await self._wait_for_reader()

    async def _wait_for_reader(self) -> None:
        """Let the reader of the events run, and wait until it has made room."""
        await self.inbox.wait_for_room()
        await asyncio.sleep(0)

    def _chunks(self, file: BinaryIO) -> Iterator[TimedPacket]:
        """Yield chunks of packets with nearly equal times; at full speed one chunk per block of the file."""
        max_span = MAX_CHUNK_SPAN * self._speed if self._speed else float("inf")
        scanner = TlogScanner()
        while data := file.read(CHUNK):
            yield from group_packets(scanner.feed(data), max_span)
        yield from group_packets(scanner.finish(), max_span)


class ReplayClock:
    """The replay times of recorded times: `speed` is a factor, and `start` is when the replay began."""

    def __init__(self, speed: float, start: float) -> None:
        self._speed = speed
        self._due = start
        self._last: float | None = None

    def due(self, recorded: float) -> float:
        """Return the replay time of a recorded time; a time before the previous one is due immediately."""
        if self._last is not None and self._speed:
            silence = min(max(recorded - self._last, 0.0), MAX_SILENCE)
            self._due += silence / self._speed
        self._last = recorded
        return self._due


def group_packets(packets: Iterable[TimedPacket], max_span: float) -> Iterator[TimedPacket]:
    """Join packets whose times are at most `max_span` seconds after the first one."""
    first, parts = 0.0, list[bytes]()
    for recorded, data in packets:
        if parts and not 0 <= recorded - first <= max_span:
            yield first, b"".join(parts)
            parts.clear()
        if not parts:
            first = recorded
        parts.append(data)
    if parts:
        yield first, b"".join(parts)
