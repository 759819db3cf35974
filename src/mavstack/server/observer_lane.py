"""The lane of clients that observe: few of their sends in each turn of the event loop.

Each send costs a fraction of a millisecond. Hundreds of observers would otherwise send between two steps of a
pilot's request, which would then take tenths of a second. In the lane they wait for each other instead, and
what they cannot be sent in time is dropped from their own queues.
"""

from __future__ import annotations

import asyncio
from typing import Final

#: Sends of clients that observe in one turn of the event loop.
WIDTH: Final = 4


class ObserverLane:
    """The lane of one station."""

    def __init__(self) -> None:
        self._places = asyncio.Semaphore(WIDTH)

    async def turn(self) -> None:
        """Wait for a turn, in which one send may follow; a send that blocks then holds no place."""
        async with self._places:
            await asyncio.sleep(0)
