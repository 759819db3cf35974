"""An observation of links until they end or the time is up: displayed, recorded, replayed onto a link."""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.link_options import with_link_options
from mavstack.cli.common.output import echo
from mavstack.cli.watch.heartbeats import send_heartbeats
from mavstack.cli.watch.link_follower import background_tasks
from mavstack.cli.watch.vehicle_relays import VehicleRelays
from mavstack.errors import LinkError
from mavstack.links import open_link
from mavstack.links.registry import resolve_url
from mavstack.logs import open_log
from mavstack.logs.recorder import Recorder

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Coroutine, Sequence
    from contextlib import AbstractContextManager
    from typing import Any, Protocol, Self

    from mavstack.cli.watch.sources import WatchedSource
    from mavstack.links import Link
    from mavstack.wire import Packet

    class Display(AbstractContextManager["Display"], Protocol):
        """A display of what is followed, which draws until it is cancelled."""

        async def run(self) -> None:
            """Draw until cancelled."""


#: Seconds between two writes to the disk itself; a loss of power loses at most the packets in between.
SYNC_INTERVAL: Final = 1.0


async def follow_sources(
    sources: Sequence[WatchedSource],
    arguments: Namespace,
    duration: float | None,
    display: Callable[[Observation], Display] | None,
    at_end: Callable[[], None] | None = None,
) -> None:
    """Follow the links of the sources together.

    Args:
        sources: The sources; those that are files are replayed.
        arguments: The options of the command.
        duration: Seconds; None: until all links have ended.
        display: Makes the display; None for none.
        at_end: Called when the links have ended, before problems are told; None for nothing.

    Raises:
        LinkError: A link cannot be opened, or nothing was received.
        LogError: The recording cannot be written.
    """
    observation = Observation(sources, arguments)
    try:
        async with observation:
            jobs = observation.jobs()
            if display is None:
                async with background_tasks(*jobs):
                    await observation.run(duration)
            else:
                with display(observation) as drawn:
                    async with background_tasks(*jobs, drawn.run()):
                        await observation.run(duration)
            if at_end is not None:
                at_end()
    except asyncio.CancelledError:  # Ctrl-C, the usual end of a recording
        observation.report_activity()
        raise
    observation.report()


class Observation:
    """The open links of the sources, with the recording and the output; an async context manager."""

    def __init__(self, sources: Sequence[WatchedSource], arguments: Namespace) -> None:
        self._sources = sources
        self._arguments = arguments
        self._links: list[Link] = []
        self._stack = AsyncExitStack()
        #: The recording; None: nothing is recorded.
        self.recorder: Recorder | None = None
        self._relays: VehicleRelays | None = None

    @property
    def activity(self) -> str:
        """The running recording and replay, in words; empty: none."""
        parts = []
        if self.recorder is not None:
            parts.append(recorded_text(self.recorder))
        if self._relays is not None:
            parts.append(self._relays.activity)
        return ", ".join(parts)

    def jobs(self) -> list[Coroutine[Any, Any, None]]:
        """Return the coroutines that run beside the links."""
        wants_heartbeats = self._arguments.heartbeat or self._arguments.heartbeat_rate
        jobs: list[Coroutine[Any, Any, None]] = []
        if wants_heartbeats:
            jobs += [send_heartbeats(link, source.follower) for link, source in self._pairs()]
        if self.recorder is not None:
            jobs.append(_sync_periodically(self.recorder))
        return jobs

    async def run(self, duration: float | None) -> None:
        """Follow all links for `duration` seconds, None until they end."""
        await asyncio.gather(*(source.follower.follow(link, duration) for link, source in self._pairs()))

    def report(self) -> None:
        """Tell what was recorded and replayed, and which links were silent; raise if all of them were."""
        self.report_activity()
        silent = [error for source in self._sources if (error := silence(source)) is not None]
        if len(silent) == len(self._sources):
            raise silent[0]
        for error in silent:
            echo(f"mav {self._arguments.command}: {error}", error=True)

    def report_activity(self) -> None:
        """Tell what was recorded and replayed."""
        if self.activity:
            echo(f"mav {self._arguments.command}: {self.activity}", error=True)

    def _pairs(self) -> list[tuple[Link, WatchedSource]]:
        return list(zip(self._links, self._sources, strict=True))

    async def __aenter__(self) -> Self:
        try:
            await self._open()
        except BaseException:
            await self._stack.aclose()
            raise
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._stack.aclose()

    async def _open(self) -> None:
        arguments = self._arguments
        if arguments.to is not None:
            relays = self._relays = VehicleRelays(arguments.to, self._vehicles)
            await self._stack.enter_async_context(relays)
            announce_exposure(arguments.command, relays.links)
            await relays.wait_for_peers(arguments.command)
        for url in with_link_options([source.text for source in self._sources], arguments):
            self._links.append(await self._stack.enter_async_context(self._link(url)))
        announce_exposure(arguments.command, self._links)
        if arguments.record is not None:
            self.recorder = self._stack.enter_context(_open_recorder(arguments))
        for source in self._sources:
            self._connect(source)

    def _link(self, url: str) -> Link:
        """Return the link of a source; among several sources, a speed applies to recordings only."""
        speed = self._arguments.speed
        if speed is None or (len(self._sources) > 1 and resolve_url(url).scheme != "file"):
            return open_link(url)
        return open_link(url, speed=speed)

    def _connect(self, source: WatchedSource) -> None:
        """Pass the packets of a source to the recording and to the output."""
        if self.recorder is not None:
            source.observer.record_to(self.recorder)
            source.follower.after_batch = self._finish_batch
        relays, show = self._relays, source.follower.show
        if relays is None:
            return

        def send(packets: Sequence[Packet], time: float) -> None:
            relays.send(packets)
            if show is not None:
                show(packets, time)

        source.follower.show = send
        source.follower.after_batch = self._finish_batch

    async def _finish_batch(self) -> None:
        """Write what was received to the recording, and wait for the link of the replay."""
        if self.recorder is not None:
            self.recorder.flush()
        if self._relays is not None:
            await self._relays.drain()

    def _vehicles(self) -> list[int]:
        """Return the system ids of the vehicles in the recording that is replayed, or of the one selected."""
        (source,) = self._sources
        with open_log(resolve_url(source.text).path, source.observer.dialect) as log:
            return [system for system in log.vehicles if self._arguments.system in (None, system)]


def silence(source: WatchedSource) -> LinkError | None:
    """Return why a source has shown no packet; None if it has."""
    follower = source.follower
    if source.observer.totals().packets > follower.refused:
        return None
    waited = f"in {follower.seconds:.1f} s"
    if follower.refused:
        problem = f"all {follower.refused} packets received {waited} are unsigned or signed with another key"
    elif follower.bytes:
        problem = (
            f"{follower.bytes} bytes received {waited}, but no MAVLink packet; "
            "check that the sender uses MAVLink, and the baud rate"
        )
    else:
        problem = f"no data received {waited}; {follower.note or 'some vehicles send only after --heartbeat'}"
    return LinkError(f"{source.title}: {problem}")


def recorded_text(recorder: Recorder) -> str:
    """Return what was recorded, in words."""
    files = recorder.files
    where = f"{len(files)} files, the last one {files[-1]}" if len(files) > 1 else str(recorder.path)
    omitted = f" ({recorder.omitted} SETUP_SIGNING left out)" if recorder.omitted else ""
    return f"recorded {recorder.packets} packets{omitted} to {where}"


def _open_recorder(arguments: Namespace) -> Recorder:
    """Open the recording of `mav watch`, or of `mav record`, which has more options."""
    options = {
        name: getattr(arguments, name, None) for name in ("format", "max_size", "max_duration", "keep")
    }
    return Recorder(arguments.record, **options)


async def _sync_periodically(recorder: Recorder) -> None:
    while True:
        await asyncio.sleep(SYNC_INTERVAL)
        await asyncio.to_thread(recorder.sync)
