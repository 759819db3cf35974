"""The base of endpoints: a configured link or file that gives its descriptors, or its bytes, to the engine.

One configured endpoint has any number of endpoints of the engine: none while it is down, one for a link with
one peer, one for each client of a server, so that each client has routes and a queue of its own.
"""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Final

from mavstack.links.address import format_address

if TYPE_CHECKING:
    from collections.abc import Coroutine, Mapping

    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig
    from mavstack.router.peer import Peer

#: The states of an endpoint.
CLOSED: Final = "closed"
OPEN: Final = "open"
LISTENING: Final = "listening"
DOWN: Final = "down"
ENDED: Final = "ended"


class Endpoint(ABC):
    """One configured endpoint.

    Attributes:
        config: Its configuration.
        state: "closed", "open", "listening" (without a client), "down" (it tries again), or "ended".
        reason: The reason why it is down or has ended; empty otherwise.
        reconnections: Number of times that it was opened again.
    """

    def __init__(self, config: EndpointConfig, attachments: Attachments) -> None:
        self.config = config
        self.state = CLOSED
        self.reason = ""
        self.reconnections = 0
        self._attachments = attachments
        self._numbers: dict[int, str] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def numbers(self) -> Mapping[int, str]:
        """The engine's numbers of the open links, and their names."""
        return self._numbers

    @property
    def listens_on(self) -> str:
        """Host and port on which it listens, as text; empty: it does not listen on a port."""
        address = getattr(self, "address", None)
        return format_address(address) if address else ""

    @property
    def dropped(self) -> Mapping[int, int]:
        """Packets lost by slow clients outside the engine, by the engine's number."""
        return {}

    @property
    def sent(self) -> Mapping[int, tuple[int, int]]:
        """Packets and bytes sent on links that send less than the engine gives them, by number."""
        return {}

    @abstractmethod
    async def open(self) -> None:
        """Open the endpoint.

        Raises:
            LinkError: It cannot be opened.
        """

    async def close(self) -> None:
        """Close the endpoint. Idempotent."""
        self.state = CLOSED
        tasks, self._tasks = self._tasks, set()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        for number in list(self._numbers):
            self._detach(number)

    def reconfigure(self, config: EndpointConfig) -> None:
        """Apply filters, rates, group and state of a configuration with the same transport."""
        self.config = config
        for number in self._numbers:
            self._attachments.configure(number, config)

    def link_closed(self, number: int, reason: str) -> None:
        """Take note that the engine closed a link."""
        self._detach(number)
        self.reason = reason

    def readable(self, number: int) -> None:  # noqa: B027 - only endpoints that carry bytes have something to do
        """Take the packets that wait for a link whose bytes the endpoint carries."""

    def _attach(
        self,
        number: int,
        name: str,
        *,
        peer: Peer | None = None,
        listening: bool = False,
        credential: str = "",
    ) -> None:
        """Take charge of a link of the engine, which gets the filters of this endpoint."""
        self._numbers[number] = name
        self._attachments.attach(number, self, name, peer=peer, listening=listening, credential=credential)
        self.state, self.reason = OPEN, ""

    def _detach(self, number: int) -> None:
        self._numbers.pop(number, None)
        self._attachments.detach(number)

    def _spawn(self, work: Coroutine[None, None, None]) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(work, name=f"endpoint {self.config.name}")
        self._tasks.add(task)
        task.add_done_callback(self._task_done)
        return task

    def _task_done(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()):
            self.state, self.reason = ENDED, f"internal error: {error!r}"
            self._attachments.report_bug(self, error)
