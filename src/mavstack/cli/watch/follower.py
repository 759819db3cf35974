"""The follower of a live link: passes its data to an observer until the link ends or the time is up."""

from __future__ import annotations

import asyncio
import sys
from contextlib import asynccontextmanager
from time import monotonic
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, LinkDown
from mavstack.wire import encode

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Coroutine, Sequence

    from mavstack.cli.watch.observer import Observer
    from mavstack.links import Link
    from mavstack.wire import Packet

GROUND_STATION = 255
MISSION_PLANNER = 190


class Follower:
    """Feeds an observer with the data of a link; `show` prints the packets."""

    def __init__(
        self, observer: Observer, show: Callable[[Sequence[Packet], float], None] | None = None
    ) -> None:
        self.observer = observer
        #: Problem of the link in words; empty if there is none.
        self.note = ""
        self.bytes = 0
        self.started = monotonic()
        self._show = show
        self._shown = False

    @property
    def seconds(self) -> float:
        """Seconds since the link is followed."""
        return monotonic() - self.started

    async def follow(self, link: Link, seconds: float | None = None) -> None:
        """Follow an open link until it ends, at most for `seconds`."""
        self.started = monotonic()
        try:
            async with asyncio.timeout(seconds) as deadline:
                async for events in link.batches():
                    now = monotonic()
                    for event in events:
                        self._event(event, now)
                    if self._shown:  # once per batch of events, not once per packet
                        self._shown = False
                        sys.stdout.flush()
        except TimeoutError:
            if not deadline.expired():
                raise

    def _event(self, event: object, now: float) -> None:
        if type(event) is BytesReceived:
            self.bytes += len(event.data)
            packets = self.observer.receive(event.channel.name, event.data, now)
            if self._show is not None and packets:
                self._show(packets, event.time)
                self._shown = True
        elif isinstance(event, ChannelOpened):
            self.note = ""
            self.observer.open(event.channel.name)
        elif isinstance(event, ChannelClosed):
            self.observer.flush(event.channel.name, now)
            self.observer.close(event.channel.name)
            self.note = f"{event.channel.name}: {event.reason}"
        elif isinstance(event, LinkDown):
            self.note = f"no connection: {event.reason}; next try in {event.retry_in:.0f} s"


async def send_heartbeats(link: Link) -> None:
    """Send the HEARTBEAT of a ground station at 1 Hz; many vehicles send no telemetry without one."""
    message = common.Heartbeat(
        type=common.MavType.GCS,
        autopilot=common.MavAutopilot.INVALID,
        system_status=common.MavState.ACTIVE,
        mavlink_version=3,
    )
    sequence = 0
    while True:
        data = encode(message, system=GROUND_STATION, component=MISSION_PLANNER, sequence=sequence)
        sequence = (sequence + 1) & 0xFF
        for channel in link.channels:
            channel.write(data)
        await asyncio.sleep(1)


@asynccontextmanager
async def background_tasks(*jobs: Coroutine[object, object, None]) -> AsyncIterator[None]:
    """Run jobs while the block runs; an error in one of them ends the block."""
    try:
        async with asyncio.TaskGroup() as group:
            tasks = [group.create_task(job) for job in jobs]
            yield
            for task in tasks:
                task.cancel()
    except BaseExceptionGroup as errors:
        raise errors.exceptions[0] from None
