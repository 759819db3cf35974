"""Replay: `file://flight.tlog?speed=2`; `speed=max` (or 0) goes as fast as the events are read.

A telemetry log is delivered without its times, which become the times of the events: a live link never had
them in its bytes, and a parser could take one for the begin of a packet. Packets within a few milliseconds
come as one chunk, and silences over a minute are cut short, so that a log in which the clock was set
replays without waiting for years. Any other file has no times to go by: it is delivered as fast as it is
read, whatever the speed. The link ends with the file; what is written to its channel is dropped.
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
from mavstack.links.explain import explain
from mavstack.links.tlog import TlogScanner, looks_like_tlog

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.links.options import Options
    from mavstack.links.tlog import Timed
    from mavstack.links.url import LinkURL

CHUNK = 1 << 17
TOGETHER = 0.005  # seconds within which packets come as one chunk
LONGEST_SILENCE = 60.0


class FileChannel(Channel):
    """The recorded peer; it cannot hear."""

    def _send(self, data: Data) -> bool:
        return False

    def _shut(self) -> None:
        pass


class FileLink(Link):
    """Replays one file."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._speed = 0.0 if options.text("speed", "1") == "max" else self._number(options.text("speed", "1"))
        self._path = Path(url.path).expanduser()

    def _number(self, text: str) -> float:
        try:
            speed = float(text)
        except ValueError:
            speed = -1.0
        if not 0 <= speed < float("inf"):
            raise LinkURLError(
                f"{self.url}: the option speed={text} must be a number such as 1 or 10, or max"
            )
        return speed

    async def _open(self) -> None:
        try:
            mode = self._path.stat().st_mode
            if stat.S_ISCHR(mode):
                raise LinkError(f"cannot open {self.url}: it is a device: use serial://{self._path}")
            file = self._path.open("rb")
        except OSError as error:
            raise explain(self.url, error) from error
        channel = FileChannel(f"file {self._path.name}", str(self._path), self._inbox.closed)
        self._inbox.opened(channel)
        self._spawn(self._replay(channel, file))

    async def _replay(self, channel: Channel, file: BinaryIO) -> None:
        with file:
            if looks_like_tlog(file.read(CHUNK)):
                file.seek(0)
                await self._replay_timed(channel, self._groups(file))
            else:
                file.seek(0)
                await self._replay_plain(channel, file)
        channel.close("end of file")
        self._inbox.end()

    async def _replay_plain(self, channel: Channel, file: BinaryIO) -> None:
        while (data := file.read(CHUNK)) and not channel.closed:
            self._inbox.put(channel, data, time())
            await self._pause()

    async def _replay_timed(self, channel: Channel, groups: Iterable[Timed]) -> None:
        clock = Pace(self._speed, asyncio.get_running_loop().time())
        for recorded, data in groups:
            due = clock.due(recorded)
            await asyncio.sleep(due - asyncio.get_running_loop().time())
            if channel.closed:
                return
            self._inbox.put(channel, data, recorded)
            await self._pause()

    async def _pause(self) -> None:
        """Let the reader of the events have its turn, and wait for it."""
        await self._inbox.room()
        await asyncio.sleep(0)

    def _groups(self, file: BinaryIO) -> Iterator[Timed]:
        """Packets of the same moment; at full speed all packets of a piece of the file."""
        together = TOGETHER * self._speed if self._speed else float("inf")
        scanner = TlogScanner()
        while data := file.read(CHUNK):
            yield from group(scanner.feed(data), together)
        yield from group(scanner.finish(), together)


class Pace:
    """When recorded moments are due in a replay that began at `start`."""

    def __init__(self, speed: float, start: float) -> None:
        self._speed = speed
        self._due = start
        self._last: float | None = None

    def due(self, recorded: float) -> float:
        """The time of the replay for a recorded time; times that go back are due at once."""
        if self._last is not None and self._speed:
            silence = min(max(recorded - self._last, 0.0), LONGEST_SILENCE)
            self._due += silence / self._speed
        self._last = recorded
        return self._due


def group(packets: Iterable[Timed], together: float) -> Iterator[Timed]:
    """Join packets whose times are at most `together` seconds after the first of them."""
    first, parts = 0.0, list[bytes]()
    for recorded, data in packets:
        if parts and not 0 <= recorded - first <= together:
            yield first, b"".join(parts)
            parts.clear()
        if not parts:
            first = recorded
        parts.append(data)
    if parts:
        yield first, b"".join(parts)
