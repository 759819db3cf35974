"""The signing keys of a node: which key a new channel signs with, and the clock that outlives the program.

A key that was set up over a channel (see `services.signing_setup`) also counts when that channel comes back,
as after a reconnect; a key that was given to this node itself counts for all channels from then on. The
program still stores the key for its next run: `KeySettled` tells it.

RADIO_STATUS is accepted unsigned: radios send it themselves and have no key.
"""

from __future__ import annotations

import asyncio
from itertools import count
from typing import TYPE_CHECKING

from mavstack.errors import SigningError
from mavstack.node.key_change import UNSIGNED
from mavstack.services.signing_setup import KeySettled, SigningSetupServer

if TYPE_CHECKING:
    from mavstack.node.engine import Engine
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.services import Service
    from mavstack.wire import Signing

#: How often the signing clock is stored, in seconds: a crash loses no more of it.
STORE_INTERVAL = 30.0


class Keys:
    """The keys and the stored clock of one node."""

    def __init__(self, engine: Engine, key: SigningKey | None, timestamps: TimestampStore | None) -> None:
        self._engine = engine
        self._key = key
        self._timestamps = timestamps
        self._by_channel: dict[str, SigningKey | None] = {}
        self._link_ids = count()
        self._task: asyncio.Task[None] | None = None

    def new_signing(self, channel_name: str) -> Signing | None:
        """The signing state of a channel that opens."""
        key = self._by_channel.get(channel_name, self._key)
        if key is None:
            return None
        timestamp = self._timestamps.load() if self._timestamps else 0
        return key.signing(next(self._link_ids) % 256, timestamp=timestamp, unsigned_ids=UNSIGNED)

    def settled(self, event: KeySettled, service: Service | None) -> None:
        """A change of keys is over."""
        if not event.changed:
            return
        if isinstance(service, SigningSetupServer):
            self._key = event.key
            self._by_channel.clear()
        else:
            for channel in self._engine.routes.heard_on(event.peer):
                self._by_channel[channel.name] = event.key

    def open(self) -> None:
        """Begin to store the clock once in a while."""
        if self._timestamps is not None:
            self._task = asyncio.get_running_loop().create_task(self._store_often())

    async def close(self) -> None:
        """Store the clock for the last time."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            self._store()

    async def _store_often(self) -> None:
        while True:
            await asyncio.sleep(STORE_INTERVAL)
            self._store()

    def _store(self) -> None:
        newest = [channel.signing.timestamp for channel in self._engine.channels if channel.signing]
        if self._timestamps is None or not newest:
            return
        try:
            self._timestamps.store(max(newest))
        except SigningError as error:
            context = {"message": "the signing clock is not stored", "exception": error}
            asyncio.get_running_loop().call_exception_handler(context)
