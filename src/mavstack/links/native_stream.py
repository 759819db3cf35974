"""The reading of a stream by a thread of the core, in place of the event loop.

Streams are TCP connections, Unix sockets and serial ports. The event loop continues to write, and to close.
While the program has too many packets to handle, the thread does not read, so that the system slows down the
peer and nothing is lost. When the stream ends, the event loop reads again, and finds the end; it also reads
if the system has no descriptor left for the thread.
"""

from __future__ import annotations

import asyncio
import os
from typing import TYPE_CHECKING

from mavstack.links.stream import StreamChannel

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack._core import Intake, Parser
    from mavstack.links.channel import Channel


def end_reading(channel: Channel) -> None:
    """Let the event loop read the stream of a channel that was to be read by a thread, if it has one."""
    if isinstance(channel, StreamChannel):
        channel.read_itself()


class StreamReading:
    """The stream of one channel in an intake.

    Args:
        channel: The channel, which does not read its stream.
        intake: The intake, to which the channel was given by `attach_fed`.
        number: The number of the channel in the intake.
        descriptor: The descriptor of the stream.
    """

    def __init__(self, channel: StreamChannel, intake: Intake, number: int, descriptor: int) -> None:
        self._channel = channel
        self._intake = intake
        self.number = number
        self._descriptor: int | None = None
        self._is_watched = False
        try:
            # Event loops watch no descriptor that a transport has.
            self._descriptor = os.dup(descriptor)
            intake.add_stream(number, descriptor, os.isatty(descriptor))
        except OSError:
            self.stop()
            channel.read_itself()

    @classmethod
    def attach(
        cls, channel: StreamChannel, intake: Intake, number: int, parser: Parser
    ) -> StreamReading | None:
        """Let the thread read the stream of a channel; return None while received bytes of it wait."""
        descriptor = channel.pass_stream()
        if descriptor is None:
            return None
        intake.attach_fed(number, parser)
        return cls(channel, intake, number, descriptor)

    def watch(self, watcher: Callable[[], None] | None) -> None:
        """Let the event loop wait for the stream in place of the thread; None: end it."""
        if self._descriptor is None:
            return
        loop = asyncio.get_running_loop()
        if watcher is not None:
            loop.add_reader(self._descriptor, watcher)
        elif self._is_watched:
            loop.remove_reader(self._descriptor)
        self._is_watched = watcher is not None

    def stop(self, error: int = 0) -> None:
        """End the reading; the channel reads its stream again. Idempotent."""
        if self._descriptor is not None:
            self.watch(None)
            os.close(self._descriptor)
            self._descriptor = None
            self._intake.remove_socket(self.number)
            self._channel.read_itself(error)

    def take_over(self, error: int = 0) -> None:
        """Let the channel read its stream, which has ended, with the number of an error or 0."""
        self.stop(error)
