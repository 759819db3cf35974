"""The signing keys of a node: which key a new channel signs with, and the clock that outlives the program.

A key that was set up over a channel (see `services.signing_setup`) also counts when that channel comes back,
as after a reconnect; a key that was given to this node itself counts for all its channels from then on. A
channel that opens while a change of keys is under way takes part in it. The program still stores the key for
its next run: `KeySettled` tells it.

The signing clock never goes back, whichever channel it ran on: a new one begins at the newest timestamp of
all others, past ones and those of the last run included. RADIO_STATUS is accepted unsigned: radios send it
themselves and have no key.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.node.key_change import apply_key_event, signing_of
from mavstack.services.signing_setup import KeySettled, ListenForKey, SigningSetupServer

if TYPE_CHECKING:
    from mavstack.node.channel_state import ChannelState
    from mavstack.node.engine import Engine
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.services import Address, Service
    from mavstack.services.signing_setup import KeyEvent

#: How often the signing clock is stored, in seconds: a crash loses no more of it.
STORE_INTERVAL = 30.0


@dataclass(slots=True)
class _Change:
    """A change of keys under way: the channels that it began on, and those that came back in its course."""

    begun: ListenForKey
    channels: list[ChannelState]
    returned: dict[str, ChannelState] = field(default_factory=dict)
    last: KeyEvent | None = None

    def concerns(self, channel: ChannelState) -> bool:
        return channel in self.channels or channel in self.returned.values()


class Keys:
    """The keys and the stored clock of one node."""

    def __init__(self, engine: Engine, key: SigningKey | None, timestamps: TimestampStore | None) -> None:
        self._engine = engine
        self._key = key
        self._timestamps = timestamps
        self._stored = 0
        self._by_channel: dict[str, SigningKey | None] = {}
        self._changes: dict[Address, _Change] = {}
        self._task: asyncio.Task[None] | None = None

    def opened(self, channel: ChannelState) -> None:
        """Let a channel that opened sign as it is known to, and take part in the change that it was in."""
        self._sign(channel, self._by_channel.get(channel.name, self._key))
        for change in self._changes.values():
            if any(channel.name == known.name for known in change.channels):
                change.returned[channel.name] = channel
                for event in (change.begun, change.last):
                    if event is not None:
                        apply_key_event(event, [channel])

    def told(self, event: KeyEvent, service: Service | None) -> None:
        """The engine changed the keys of the channels on which a peer is heard."""
        heard_on = self._engine.routes.heard_on(event.peer)
        if isinstance(event, ListenForKey):
            self._changes[event.peer] = _Change(event, list(heard_on))
            return
        change = self._changes.get(event.peer)
        if change is None:
            return
        change.last = event
        # The peer is silent on what came back, so the engine does not know that it leads there.
        apply_key_event(event, [channel for channel in change.returned.values() if channel not in heard_on])
        if isinstance(event, KeySettled):
            del self._changes[event.peer]
            if event.changed:
                self._changed(event, change, is_ours=isinstance(service, SigningSetupServer))

    def _changed(self, event: KeySettled, change: _Change, *, is_ours: bool) -> None:
        heard_on = self._engine.routes.heard_on(event.peer)
        if is_ours:
            self._key = event.key
            self._by_channel.clear()
        else:
            self._by_channel.update((channel.name, event.key) for channel in (*change.channels, *heard_on))
        for channel in self._engine.channels if is_ours else heard_on:
            if not change.concerns(channel):
                self._sign(channel, event.key)

    def _sign(self, channel: ChannelState, key: SigningKey | None) -> None:
        channel.signing = signing_of(key, channel, max(self._stored, self._engine.signing_clock))

    def open(self) -> None:
        """Take up the clock of the last run, and begin to store it; raises SigningError if it is damaged."""
        if self._timestamps is not None:
            self._stored = self._timestamps.load()
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
        clock = self._engine.signing_clock
        if self._timestamps is None or not clock:
            return
        try:
            self._timestamps.store(clock)
        except Exception as error:  # noqa: BLE001 (a program's own store may raise anything; the node goes on)
            context = {"message": "the signing clock is not stored", "exception": error}
            asyncio.get_running_loop().call_exception_handler(context)
