"""The lane of clients that observe: few of their sends in each turn of the event loop.

Each send costs a fraction of a millisecond. Hundreds of observers would otherwise send between two steps of a
pilot's request, which would then take tenths of a second. In the lane they wait for each other instead, and
what they cannot be sent in time is dropped from their own queues. Answers with a result, which many of them
may wait for, have a separate lane: to make JSON of a plan or of all parameters takes longer.
"""

from __future__ import annotations

import asyncio
from typing import Final

#: Maximum number of sends to observing clients per turn of the event loop.
WIDTH: Final = 4


class ObserverLane:
    """One lane of a station.

    Args:
        width: The number of clients whose turn comes in one turn of the event loop.
    """

    def __init__(self, width: int = WIDTH) -> None:
        self._places = asyncio.Semaphore(width)

    async def turn(self) -> None:
        """Wait for a turn, in which one send may follow; a send that blocks then holds no place."""
        async with self._places:
            await asyncio.sleep(0)
