"""Requests that are carried out once, however often they arrive.

A client that gets no answer repeats its request, and cannot know whether the vehicle has carried it out. With
an id both requests are one: the second one gets the answer of the first.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any

#: Maximum number of requests that are remembered.
MAX_REQUESTS: Final = 512
#: Maximum length of a request id in characters.
MAX_ID: Final = 64


class RequestLog:
    """The requests of one vehicle by their ids.

    Args:
        limit: The number of finished requests that are remembered.
    """

    def __init__(self, limit: int = MAX_REQUESTS) -> None:
        #: The number of requests that were received more than once.
        self.repeated = 0
        self._limit = limit
        self._known: dict[str, asyncio.Task[bytes]] = {}

    async def answer(self, key: str, work: Callable[[], Coroutine[Any, Any, bytes]]) -> bytes:
        """Return the answer of a request, which is carried out unless it is known.

        Args:
            key: The id; empty: it has none, and is carried out.
            work: Carries it out.
        """
        if not key:
            return await work()
        task = self._known.get(key)
        if task is None:
            task = self._known[key] = asyncio.get_running_loop().create_task(work())
            self._forget_old()
        else:
            self.repeated += 1
        return await asyncio.shield(task)

    async def close(self) -> None:
        """Cancel the requests that are carried out."""
        for task in self._known.values():
            task.cancel()
        await asyncio.gather(*self._known.values(), return_exceptions=True)

    def _forget_old(self) -> None:
        ended = [key for key, task in self._known.items() if task.done()]
        for key in ended[: max(len(self._known) - self._limit, 0)]:
            del self._known[key]
