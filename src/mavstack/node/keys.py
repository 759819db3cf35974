"""The signing keys of a node: the key of each new channel, and the signing timestamp between two runs.

A channel signs with the key that the URL of its link names, or else with the key of the node.

A key that was set up over a channel (see `services.signing_setup`) is used again when that channel reopens,
as after a reconnect; a key that a remote component installed on this node applies to all its channels from
then on. A channel that opens during a change of keys takes part in it. A channel without a key that receives
a packet of a verified component, signed with its key, uses that key too. The program stores the key for its
next run; the event `KeySettled` has it.

Signing timestamps never decrease, whichever channel they are for: a new channel starts at the newest
timestamp of all others, closed ones and those of the last run included. The timestamps received in each
stream are kept as well, for all channels of a key and for the next run, so that no packet is accepted twice.
Unless the state of the last run is known completely, all packets from before the start are refused: without
a store, with a new one, after a run that was killed, and beside another process that uses the store. Peers
adopt newer timestamps, so that their next packets are accepted. RADIO_STATUS is accepted unsigned: radios
send it themselves and have no key.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.node.key_change import apply_key_event
from mavstack.security.timestamps import UNITS_PER_SECOND, LastRun, time_if_set, timestamp_at
from mavstack.services.signing_setup import KeySettled, ListenForKey, SigningSetupServer
from mavstack.services.signing_setup.key_change import signed_with

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.links import Link
    from mavstack.node.channel_state import ChannelState
    from mavstack.node.engine import Engine
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.services import Address, Service
    from mavstack.services.signing_setup import KeyEvent
    from mavstack.wire import Packet

#: Seconds between two writes of the signing timestamp; a crash loses at most this time.
STORE_INTERVAL = 30.0
#: Seconds between two checks of a packet on a channel without a key, and maximum number of keys per check.
ADOPTION_INTERVAL = 0.1
MAX_ADOPTION_KEYS = 16


@dataclass(slots=True)
class _Change:
    """A running change of keys: the channels that it started on, and those that reopened meanwhile."""

    start: ListenForKey
    channels: list[ChannelState]
    reopened: dict[str, ChannelState] = field(default_factory=dict)
    last: KeyEvent | None = None

    def concerns(self, channel: ChannelState) -> bool:
        return channel in self.channels or channel in self.reopened.values()


class Keys:
    """The signing keys and the stored signing timestamp of one node."""

    def __init__(
        self,
        engine: Engine,
        key: SigningKey | None,
        timestamps: TimestampStore | None,
        link_keys: Mapping[Link, SigningKey],
    ) -> None:
        self._engine = engine
        self._key = key
        self._link_keys = dict(link_keys)
        self._timestamps = timestamps
        self._stored = 0
        self._by_channel: dict[str, SigningKey | None] = {}
        self._changes: dict[Address, _Change] = {}
        self._next_adoption = 0.0
        engine.adopt_key = self._adopt
        self._task: asyncio.Task[None] | None = None

    def add_links(self, keys: Mapping[Link, SigningKey]) -> None:
        """Use the keys that the URLs of further links name."""
        self._link_keys.update(keys)

    def remove_link(self, link: Link) -> None:
        """Forget the key of a link that was removed."""
        self._link_keys.pop(link, None)

    def on_channel_opened(self, channel: ChannelState, link: Link) -> None:
        """Set the key of a channel that opened; during a change of keys of its name, it joins that change."""
        self._sign(channel, self._by_channel.get(channel.name, self._link_keys.get(link, self._key)))
        for change in self._changes.values():
            if any(channel.name == known.name for known in change.channels):
                change.reopened[channel.name] = channel
                for event in (change.start, change.last):
                    if event is not None:
                        apply_key_event(event, [channel], self._engine.signing_states)

    def on_key_event(self, event: KeyEvent, service: Service | None) -> None:
        """Follow a change of keys, which the engine applied to the channels on which the peer is heard."""
        heard_on = self._engine.routes.heard_on(event.peer)
        if isinstance(event, ListenForKey):
            self._changes[event.peer] = _Change(event, list(heard_on))
            return
        change = self._changes.get(event.peer)
        if change is None:
            return
        change.last = event
        # The engine has no route over reopened channels, on which the peer has sent nothing yet.
        reopened = [channel for channel in change.reopened.values() if channel not in heard_on]
        apply_key_event(event, reopened, self._engine.signing_states)
        if isinstance(event, KeySettled):
            del self._changes[event.peer]
            if event.changed:
                self._apply_change(event, change, is_own=isinstance(service, SigningSetupServer))

    def _apply_change(self, event: KeySettled, change: _Change, *, is_own: bool) -> None:
        heard_on = self._engine.routes.heard_on(event.peer)
        if is_own:
            self._key = event.key
            self._by_channel.clear()
            self._link_keys.clear()
        else:
            self._by_channel.update((channel.name, event.key) for channel in (*change.channels, *heard_on))
        for channel in self._engine.channels if is_own else heard_on:
            if not change.concerns(channel):
                self._sign(channel, event.key)

    def _adopt(self, channel: ChannelState, packet: Packet, now: float) -> bool:
        """Use the key of other channels for a channel without one, if a packet is signed with that key."""
        if now < self._next_adoption or self._changes:
            return False
        self._next_adoption = now + ADOPTION_INTERVAL
        keys = [key for key in self._by_channel.values() if key is not None]
        for key in keys[-MAX_ADOPTION_KEYS:]:
            if signed_with(packet, key, now):
                self._by_channel[channel.name] = key
                self._sign(channel, key)
                return bool(channel.parser.feed(packet.raw, time_if_set(now)))  # no packet if it is a replay
        return False

    def _sign(self, channel: ChannelState, key: SigningKey | None) -> None:
        clock = max(self._stored, self._engine.signing_clock, channel.clock)
        channel.signing = self._engine.signing_states.create(key, channel.link_id, clock)
        if key is None:
            self._engine.routes.unverify(channel)

    def open(self, now: float) -> None:
        """Load the state of the last run, and start to store it; raises SigningError if it cannot be read."""
        present = 0 if time_if_set(now) is None else timestamp_at(now)
        last_run = LastRun() if self._timestamps is None else self._timestamps.begin_run(present)
        floor, self._stored = last_run.floor, last_run.timestamp
        if present and not last_run.is_complete:
            floor = max(self._stored, present)
        elif self._stored and not last_run.is_complete:
            floor = self._stored = self._stored + int(STORE_INTERVAL * UNITS_PER_SECOND)
        self._engine.signing_states.restore(last_run, floor)
        if self._timestamps is not None:
            self._task = asyncio.get_running_loop().create_task(self._store_periodically())

    async def close(self) -> None:
        """Store the timestamp for the last time."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            self._store(running=False)

    async def _store_periodically(self) -> None:
        while True:
            await asyncio.sleep(STORE_INTERVAL)
            self._store(running=True)

    def _store(self, *, running: bool) -> None:
        if self._timestamps is None:
            return
        states = self._engine.signing_states
        clock = max(self._stored, self._engine.signing_clock)
        try:
            self._timestamps.store(clock, states.streams(), floor=states.floor, running=running)
        except Exception as error:  # noqa: BLE001 (a program's store may raise anything)
            context = {"message": "the signing timestamp could not be stored", "exception": error}
            asyncio.get_running_loop().call_exception_handler(context)
