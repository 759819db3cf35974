"""The reading of a UDP socket by a thread of the core, in place of the event loop.

The thread parses the datagrams of attached channels; those of all other senders come to the link, which
admits new peers as ever. If the program does not keep up, the link reads the socket itself for a moment, with
its fair backlog and its filter against floods; longer each time, if the program soon does not keep up again.
"""

from __future__ import annotations

import asyncio
from time import monotonic
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack._core import Intake, Parser
    from mavstack.links.address import Address
    from mavstack.links.udp import UdpLink
    from mavstack.links.udp_channel import UdpChannel

#: Seconds for which the link reads the socket after the program was too slow; doubled each time, except
#: after the program has kept up for the longest time.
MIN_TIME: Final = 0.05
MAX_TIME: Final = 1.6


class NativeReading:
    """The socket of one link in an intake.

    Args:
        link: The link; it is open.
        intake: The intake.
        number: The number of the socket in the intake.
    """

    def __init__(self, link: UdpLink, intake: Intake, number: int) -> None:
        self._link = link
        self._intake = intake
        self.number = number
        self._taken_over_at: float | None = None
        self._returned_at = -MAX_TIME
        self._time = MIN_TIME
        self._watcher: Callable[[], None] | None = None

    def start(self) -> None:
        """Let the thread read the socket."""
        self._taken_over_at = None
        descriptor = self._link.pass_socket()
        if descriptor is not None:
            self._intake.add_socket(self.number, descriptor)
            self.watch(self._watcher)

    def watch(self, watcher: Callable[[], None] | None) -> None:
        """Let the event loop wait for the socket in place of the thread; None: end it."""
        self._watcher = watcher
        if self._taken_over_at is None:
            self._link.watch_socket(watcher)

    def stop(self) -> None:
        """End the reading. Idempotent."""
        self._taken_over_at = None
        self._intake.remove_socket(self.number)

    def take_over(self, error: int = 0) -> None:
        """Let the link read its socket, which the thread reads no more."""
        now = monotonic()
        self._time = min(2 * self._time, MAX_TIME) if now < self._returned_at + MAX_TIME else MIN_TIME
        self._taken_over_at = now
        self._link.read_itself()

    @property
    def is_due(self) -> bool:
        """True if the link is to return the socket to the thread, as soon as it has handled what it read."""
        return self._taken_over_at is not None and monotonic() >= self._taken_over_at + self._time

    def handled(self) -> None:
        """Return the socket to the thread if it is due; the link has handled what it read."""
        if self.is_due:
            self._link.pass_socket()
            # The events of new channels, which the reader of the link handles in its task, come first.
            asyncio.get_running_loop().call_soon(self._resume)

    def _resume(self) -> None:
        if self._taken_over_at is not None and not self._link.closed:
            self._returned_at = monotonic()
            self.start()

    def receive(self, data: bytes, address: Address, count: int) -> None:
        """Receive datagrams of a sender whose packets the thread does not parse."""
        self._link.receive(data, address, count)

    def attach(self, number: int, channel: UdpChannel, parser: Parser) -> bool:
        """Let the thread parse the datagrams of a channel; return whether it does from now on."""
        address = self._link.sender_of(channel)
        if address is None or not self._link.inbox.is_read:
            return False
        return self._intake.attach(number, self.number, address, parser)
