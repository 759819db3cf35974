"""The signing gateway: signatures are verified, removed, made or replaced, for each endpoint.

    [endpoint.field.signing]
    in = "field"                          # key that packets from the endpoint are signed with
    out = "field"                         # key that packets to the endpoint get signed with
    allow_unsigned = ["RADIO_STATUS"]     # also accepted unsigned (default)
    strip = true                          # verified signatures are removed (default)

A link with `in` accepts nothing unsigned but these messages. MAVLink 1 cannot be signed, so its packets count
as unsigned: speaking the older version does not get around the gateway. A vehicle without signing behind a
gateway is thereby reached only by those who have the key of the other link. Links of one key share the
timestamps of their streams, so that a packet of one link is a replay on the other.

The engine verifies and signs; this module has the keys and the timestamps, which are kept on disk as those of
a node (see `mavstack.node.keys`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol

from mavstack.errors import SigningError
from mavstack.node.signing_states import SigningStates
from mavstack.security.key_store import find_key, key_directory
from mavstack.security.timestamps import UNITS_PER_SECOND, LastRun, time_if_set, timestamp_at

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from mavstack.router.config import SigningConfig
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.wire import Signing

#: Seconds between two writes of the timestamps; a crash loses at most this time.
STORE_INTERVAL: Final = 30.0
_MAX_LINK_ID: Final = 255


def timestamps_path() -> Path:
    """Return the file with the timestamps of this user's routers, beside the keys; it may not exist yet."""
    return key_directory().parent / "router.timestamps"


class SigningEngine(Protocol):
    """The part of the router's engine that a gateway needs."""

    def set_signing(
        self,
        endpoint: int,
        incoming: Signing | None = None,
        outgoing: Signing | None = None,
        *,
        allow_unsigned: Iterable[int] = (),
        strip: bool = True,
    ) -> None:
        """Verify the packets from an endpoint, and sign those to it."""


class Gateway:
    """The keys and timestamps of one router.

    Args:
        timestamps: Returns the store that keeps the timestamps for the next run; called when the first key is
            used. None: packets from before the start are refused.
    """

    def __init__(self, timestamps: Callable[[], TimestampStore] | None = None) -> None:
        self._make_store = timestamps
        self._timestamps: TimestampStore | None = None
        self._states = SigningStates()
        self._keys: dict[str, SigningKey] = {}
        self._clock = 0
        self._next_store = 0.0
        self._next_link_id = 0
        self._is_open = False

    def _open(self, now: float) -> None:
        """Load the timestamps of the last run, when the first key is used."""
        self._is_open = True
        self._next_store = now + STORE_INTERVAL
        present = 0 if time_if_set(now) is None else timestamp_at(now)
        if self._make_store is not None:
            self._timestamps = self._make_store()
        last_run = LastRun() if self._timestamps is None else _begin_run(self._timestamps, present)
        floor, self._clock = last_run.floor, last_run.timestamp
        if present and not last_run.is_complete:
            floor = max(self._clock, present)
        elif self._clock and not last_run.is_complete:
            floor = self._clock = self._clock + int(STORE_INTERVAL * UNITS_PER_SECOND)
        self._clock = max(self._clock, present)
        self._states.restore(last_run, floor)

    def load_keys(self, configs: Iterable[SigningConfig]) -> bool:
        """Read keys, so that a link that opens later needs no file.

        Args:
            configs: The configurations of the endpoints.

        Returns:
            True if a key that was read before has changed.

        Raises:
            SigningError: A key cannot be read; the keys in use stay.
        """
        names = {name for each in configs for name in (each.incoming, each.outgoing) if name}
        keys = {name: find_key(name) for name in names}
        changed = any(name in self._keys and self._keys[name] != key for name, key in keys.items())
        self._keys |= keys
        return changed

    def apply(self, engine: SigningEngine, endpoint: int, config: SigningConfig | None, now: float) -> None:
        """Set the signing of an endpoint.

        Args:
            engine: The engine.
            endpoint: Number of the endpoint.
            config: Its configuration; None: signatures pass unchanged.
            now: Unix time in seconds.

        Raises:
            SigningError: A key or the timestamps cannot be read, or the timestamps cannot be stored.
        """
        if config is None:
            engine.set_signing(endpoint)
            return
        if not self._is_open:
            self._open(now)
        engine.set_signing(
            endpoint,
            self._state(self._key(config.incoming)),
            self._state(self._key(config.outgoing)),
            allow_unsigned=sorted(config.allow_unsigned),
            strip=config.strip,
        )

    def is_store_due(self, now: float) -> bool:
        """Return whether the timestamps should be stored again; True once in `STORE_INTERVAL` seconds."""
        is_due = self._is_open and now >= self._next_store
        if is_due:
            self._next_store = now + STORE_INTERVAL
        return is_due

    def store(self, *, running: bool = True) -> None:
        """Store the timestamps, every `STORE_INTERVAL` seconds and at the end.

        Args:
            running: False: the router ends.

        Raises:
            SigningError: The file cannot be written.
        """
        if self._timestamps is not None and self._is_open:
            streams = self._states.streams()
            clock = max(self._clock, self._states.clock)
            self._timestamps.store(clock, streams, floor=self._states.floor, running=running)

    def _key(self, name: str) -> SigningKey | None:
        if name and name not in self._keys:
            self._keys[name] = find_key(name)
        return self._keys[name] if name else None

    def _state(self, key: SigningKey | None) -> Signing | None:
        """Return the state of one direction, with a link id of its own: its stream is no other's."""
        link_id = self._next_link_id
        self._next_link_id = (link_id + 1) % (_MAX_LINK_ID + 1)
        return self._states.create(key, link_id, self._clock)


def _begin_run(timestamps: TimestampStore, present: int) -> LastRun:
    """Read the timestamps of the last run; a router without keys needs no directory for them."""
    directory = timestamps.path.parent
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise SigningError(
            f"cannot create {directory} for the signing timestamps: {error.strerror or error}"
        ) from None
    return timestamps.begin_run(present)
