"""The signing states of a node's channels: one shared state for each key.

The channels of a key share its clock and the timestamps of its streams, so that a packet accepted on one
channel is refused as a replay on every other, also on one that opens later. The last run of the program may
hand over its streams.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import message_ids
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack._core import HasCoreDialect
    from mavstack.security import SigningKey
    from mavstack.security.timestamps import LastRun, StreamId
    from mavstack.wire import Signing

#: Messages that are accepted unsigned: radios send RADIO_STATUS themselves and have no key.
UNSIGNED = tuple(message_ids(common.RadioStatus))
#: Seconds by which a packet may arrive after a newer one of its stream, which may use two channels.
REORDER_SLACK = 1.0
#: Maximum number of keys whose streams are kept; the least recently used key is dropped first.
MAX_KEYS = 16


class SigningStates:
    """The signing state of each key, from which those of its channels are made."""

    def __init__(self) -> None:
        self._states: list[tuple[SigningKey, Signing]] = []
        self._last_run: LastRun | None = None
        #: Packets of all streams with timestamps up to this one are refused.
        self.floor = 0

    def restore(self, last_run: LastRun, floor: int) -> None:
        """Refuse the packets of the last run, and all packets with a timestamp up to `floor`."""
        self._last_run, self.floor = last_run, floor
        for key, state in self._states:
            state.restore(last_run.streams_of(key), floor=floor)

    def create(self, key: SigningKey | None, link_id: int, timestamp: int) -> Signing | None:
        """Return a signing state for a channel, its clock at `timestamp` or later; None without a key."""
        if key is None:
            return None
        state = self._state_of(key, timestamp)
        if timestamp > state.timestamp:
            state.advance(timestamp)
        return state.for_link(link_id)

    @property
    def clock(self) -> int:
        """The newest timestamp used or received with any key; 0 without a key."""
        return max((state.timestamp for _, state in self._states), default=0)

    def authenticates(self, data: bytes, dialect: HasCoreDialect, now: float) -> bool:
        """Return whether bytes begin with a packet that has a recent signature of one of the keys.

        It changes no state, so it accepts repeated packets: only `Parser` decides which packets are received.

        Args:
            data: Bytes of a sender that has no channel yet, such as one datagram.
            dialect: The dialect of the packets.
            now: Unix time in seconds.
        """
        fresh = (key.signing(timestamp=state.timestamp) for key, state in self._states)
        return any(Parser(dialect, signing=signing).feed(data, now) for signing in fresh)

    def streams(self) -> list[tuple[SigningKey, Mapping[StreamId, int]]]:
        """Return the newest timestamp of each stream of each key."""
        return [(key, state.stream_timestamps) for key, state in self._states]

    def _state_of(self, key: SigningKey, timestamp: int) -> Signing:
        known = next((entry for entry in self._states if entry[0] == key), None)
        if known is not None:
            self._states.remove(known)
            self._states.append(known)
            return known[1]
        state = key.signing(timestamp=timestamp, unsigned_ids=UNSIGNED, reorder_slack=REORDER_SLACK)
        if self._last_run is not None:
            state.restore(self._last_run.streams_of(key), floor=self.floor)
        self._states = [*self._states[-MAX_KEYS + 1 :], (key, state)]
        return state
