"""Polls the messages of a flight controller, and notices when it is silent.

The poller asks for one message after the other by its schedule. A message that the firmware refuses is not
asked for again until it restarts. Errors of single requests are counted; `on_silence` is called when nothing
was answered for `SILENCE_TIMEOUT`, and `on_contact` when it answers again.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp.poll_schedule import PollSchedule
from mavstack.errors import InvalidStateError, LinkError, MspDecodeError, MspDenied, MspError, RemoteCancelled
from mavstack.msp import Priority

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping

    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.msp.messages.base import MspMessage

#: Seconds without an answer after which contact to the flight controller is lost.
SILENCE_TIMEOUT: Final = 3.0
#: Seconds between attempts while there is no contact.
RETRY_INTERVAL: Final = 0.5
#: Seconds after the command to restart until the flight controller is asked again.
RESTART_PAUSE: Final = 1.0
#: Seconds for which one poll may wait for its answer.
POLL_TIMEOUT: Final = 1.0
#: Maximum seconds between two checks of the poll intervals, which clients change.
MAX_IDLE: Final = 0.25
#: Maximum interval in seconds of polls that are sent before requests for settings; slower polls are sent
#: after them.
FAST: Final = 0.2

logger = logging.getLogger("mavstack.bridges.msp")


class Poller:
    """The polling of one flight controller.

    Args:
        controller: The flight controller.
        intervals: Returns the messages to poll, and their intervals in seconds.
        on_message: Called with each message.
        on_silence: Called when the flight controller has become silent.
        on_contact: Awaited when it answers again, before polling continues.
    """

    def __init__(
        self,
        controller: FlightController,
        intervals: Callable[[], Mapping[type[MspMessage], float]],
        *,
        on_message: Callable[[MspMessage], None],
        on_silence: Callable[[], None],
        on_contact: Callable[[], Awaitable[None]],
    ) -> None:
        self._controller = controller
        self._intervals = intervals
        self._on_message, self._on_silence, self._on_contact = on_message, on_silence, on_contact
        self._schedule: PollSchedule[type[MspMessage]] = PollSchedule()
        self._refused: set[type[MspMessage]] = set()
        self._wake = asyncio.Event()
        self._answered_at = 0.0
        #: True while there is no contact.
        self.silent = False
        self._pause = 0.0
        #: Polls without a valid answer.
        self.failures = 0

    def wake(self) -> None:
        """Look at the intervals now, because they changed."""
        self._wake.set()

    def expect_restart(self) -> None:
        """Treat the flight controller as silent, because it was told to restart."""
        self.silent, self._pause = True, RESTART_PAUSE
        self._on_silence()
        self.wake()

    async def run(self) -> None:
        """Poll for ever."""
        loop = asyncio.get_running_loop()
        self._answered_at = loop.time()
        while True:
            if self.silent:
                await self._find_again()
            now = loop.time()
            wanted = {kind: each for kind, each in self._intervals().items() if kind not in self._refused}
            self._schedule.set_intervals(wanted, now)
            kind = self._schedule.take(now)
            if kind is None:
                await self._wait(self._schedule.next_due() - now)
            else:
                await self._poll(kind, wanted[kind])
                self._schedule.finished(now, loop.time())

    async def _poll(self, kind: type[MspMessage], interval: float) -> None:
        loop = asyncio.get_running_loop()
        priority = Priority.TELEMETRY if interval <= FAST else Priority.BACKGROUND
        try:
            message = await self._controller.get(kind, priority=priority, timeout=POLL_TIMEOUT)
        except MspDenied:
            logger.info("%s: the firmware has no %s", self._controller.name, kind.NAME)
            self._refused.add(kind)
        except MspDecodeError as error:
            logger.warning("%s", error)
            self._refused.add(kind)
        except (MspError, LinkError, RemoteCancelled, InvalidStateError):
            self.failures += 1
            await self._check_silence()
            return
        else:
            if not self.silent:  # without contact, this may be a late reply from before a restart
                self._on_message(message)
        self._answered_at = loop.time()

    async def _check_silence(self) -> None:
        if asyncio.get_running_loop().time() - self._answered_at > SILENCE_TIMEOUT:
            logger.warning("%s: no answer for %g s", self._controller.name, SILENCE_TIMEOUT)
            self.silent = True
            self._on_silence()
        await asyncio.sleep(RETRY_INTERVAL if not self._controller.connected else 0)

    async def _find_again(self) -> None:
        """Wait until the flight controller answers, which may have restarted with other settings."""
        await asyncio.sleep(self._pause)
        self._pause = 0.0
        while True:
            try:
                await self._controller.identify()
                await self._on_contact()
            except (MspError, LinkError, RemoteCancelled, InvalidStateError):
                await asyncio.sleep(RETRY_INTERVAL)
            else:
                break
        logger.info("%s: it answers again", self._controller.name)
        self.silent = False
        self._refused.clear()
        self._answered_at = asyncio.get_running_loop().time()

    async def _wait(self, seconds: float) -> None:
        self._wake.clear()
        try:
            async with asyncio.timeout(max(min(seconds, MAX_IDLE), 0)):
                await self._wake.wait()
        except TimeoutError:
            return
