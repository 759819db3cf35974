"""Real firmware in a world, in a thread of its own, for programs and tests without an event loop."""

from __future__ import annotations

import asyncio
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Final, Self, TypeVar

from mavstack.errors import InvalidStateError
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.simulators.firmware_session import FirmwareSession

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from mavstack.simulators.firmware_session import FirmwareOptions
    from mavstack.simulators.simulator import Simulator

Result = TypeVar("Result")

#: Maximum number of output lines of the program that are kept.
MAX_LINES: Final = 10_000


class BackgroundFirmware:
    """A firmware that flies in a thread; a context manager.

    Args:
        options: The options of the flight.

    Attributes:
        events: Lines about the conversation with the firmware.
        lines: The last lines of the program's output.

    Raises:
        InvalidArgumentError: An option is wrong; the text says which.
    """

    def __init__(self, options: FirmwareOptions) -> None:
        self.events: list[str] = []
        self.lines: deque[str] = deque(maxlen=MAX_LINES)
        self._session = FirmwareSession(options, on_event=self.events.append, on_line=self.lines.append)
        self._portal: BlockingPortal | None = None
        self._run: asyncio.Task[None] | None = None

    @property
    def url(self) -> str:
        """The URL of a link to the vehicle."""
        return self._session.url

    @property
    def simulator(self) -> Simulator:
        """The world. Read it freely; change it only through `call`."""
        return self._session.simulator

    def inject(self, fault: str, *, after: float = 0.0, duration: float | None = None) -> None:
        """Inject a fault of a sensor; see `Simulator.inject`."""
        self.call(lambda: self.simulator.inject(fault, after=after, duration=duration))

    def call(self, function: Callable[[], Result]) -> Result:
        """Call a function between two steps, and return its result.

        Raises:
            InvalidStateError: The firmware is not running.
        """
        if self._portal is None:
            raise InvalidStateError("calling a function failed: the firmware is not running; use `with`")
        return self._portal.call(function)

    def __enter__(self) -> Self:
        self._portal = BlockingPortal()
        try:
            self._portal.wait(self._open())
        except BaseException:
            self._portal.close()
            self._portal = None
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        portal, self._portal = self._portal, None
        if portal is not None:
            try:
                portal.wait(self._close())
            finally:
                portal.close()

    async def _open(self) -> None:
        await self._session.__aenter__()
        self._run = asyncio.get_running_loop().create_task(self._session.run())

    async def _close(self) -> None:
        if self._run is not None:
            self._run.cancel()
            with suppress(asyncio.CancelledError, Exception):
                await self._run
        await self._session.__aexit__(None, None, None)
