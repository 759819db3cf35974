"""The detector of several senders with one address (see the package)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.services.heartbeat.board_ids import BoardIds
from mavstack.services.heartbeat.boot_tracker import (
    CONFLICT_ENDS_AFTER,
    MAX_CHANNELS,
    MAX_PATH_DELAY,
    BootTracker,
    Finding,
)
from mavstack.services.heartbeat.channel_clocks import ChannelClocks
from mavstack.services.heartbeat.conflicting_sender import Conflict, ConflictingSender
from mavstack.services.heartbeat.interleaved_states import InterleavedStates

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.services.version import AutopilotVersion

Key = TypeVar("Key")

#: The number of alternations between two types that show a conflict.
MIN_ALTERNATIONS = 2
MAX_SENDERS = 4
#: Seconds without a packet after which the address no longer counts as received on a channel.
CHANNEL_SILENCE = 5.0


@dataclass(slots=True)
class _Seen:
    """When and on which channels one type was received."""

    at: float
    channels: dict[str, None] = field(default_factory=dict)


@dataclass(slots=True)
class _Heard:
    """The last packets of one channel."""

    since: float
    at: float
    booted_at: float | None = None
    position: tuple[float, float] | None = None


class AddressConflictDetector:
    """The detector for one address; it owns the address's boot tracker.

    Args:
        round_trip: Returns the longest round trip of late to the address over a channel, in seconds.
    """

    __slots__ = (
        "_alternations",
        "_boards",
        "_clocks",
        "_contradicted",
        "_heard",
        "_states",
        "_type",
        "_types",
        "boot_tracker",
        "in_conflict",
    )

    def __init__(
        self, round_trip: Callable[[str, float], float] = lambda channel, now: MAX_PATH_DELAY
    ) -> None:
        self.boot_tracker = BootTracker()
        self.in_conflict = False
        self._boards = BoardIds()
        self._clocks = ChannelClocks(round_trip)
        self._states = InterleavedStates()
        self._heard: dict[str, _Heard] = {}
        self._type: tuple[int, int] | None = None
        self._types: dict[tuple[int, int], _Seen] = {}
        self._alternations = 0
        self._contradicted: dict[str, float] = {}

    @property
    def is_one_boot(self) -> bool:
        """True while all messages come from one boot of one sender."""
        return not self.in_conflict and len(self.boot_tracker.boots) == 1

    def channels(self, now: float) -> tuple[str, ...]:
        """Return the channels on which the address is heard."""
        return tuple(name for name, heard in self._heard.items() if now - heard.at < CHANNEL_SILENCE)

    def joined_at(self, now: float) -> float:
        """Return when the last one of the channels on which the address is heard came, Unix seconds."""
        return max((self._heard[name].since for name in self.channels(now)), default=0.0)

    def is_one_board(self, now: float) -> bool:
        """Return whether the same unique id was reported on every channel on which the address is heard."""
        boards = [self._boards.on(name) for name in self.channels(now)]
        return all(board is not None and board is boards[0] for board in boards)

    def is_suspect(self) -> bool:
        """Return whether the boot times are not those of one sender: its unique ids are worth a question."""
        return self.in_conflict or len(self.boot_tracker.boots) > 1

    def forget_channel(self, channel: str, now: float) -> Finding:
        """Forget a channel that has ended or is silent: the next sender on it may be another one.

        A conflict ends with it if only one sender is left.
        """
        senders = self._senders(now) if self.in_conflict else ()
        self._heard.pop(channel, None)
        self._boards.forget_channel(channel)
        self._clocks.forget_channel(channel)
        left = [sender for sender in senders if set(sender.channels) - {channel}]
        if not self.in_conflict or len(left) > 1:
            return Finding.NOTHING
        self.boot_tracker = BootTracker()
        self._states.clear()
        self._contradicted.clear()
        self._types = {key: seen for key, seen in self._types.items() if set(seen.channels) - {channel}}
        return self._end(now)

    def note_expected(self, boot_ms: int, seen_at: float, channel: str) -> None:
        """Record the last message of the current boot, of which this detector did not get those before."""
        heard = self._heard.get(channel)
        if heard is not None:
            heard.at = max(heard.at, seen_at)
        self.boot_tracker.note_expected(boot_ms, seen_at, channel)

    def observe_message(self, message: Message, boot_ms: int, now: float, channel: str) -> Finding:
        """Check the boot time and the state of a message."""
        heard = self._record_channel(now, channel)
        heard.booted_at = now - boot_ms / 1000
        if isinstance(message, common.GlobalPositionInt) and (message.lat or message.lon):
            heard.position = message.lat / 1e7, message.lon / 1e7
        finding = self.boot_tracker.observe(boot_ms, now, channel)
        if finding is Finding.REBOOTED:
            self._forget_boot()
            return Finding.NOTHING if self.in_conflict else finding
        if finding is Finding.CONFLICT:
            return self._begin("boot time", now)
        if finding is Finding.CONFLICT_ENDED:
            self._contradicted.pop("boot time", None)
        if self._clocks.add(boot_ms, now, channel) and not self.is_one_board(now):
            return self._begin("boot time", now)
        if contradicted := self._states.add(message, now):
            return self._begin(contradicted, now)
        return self._check_boards(now)

    def observe_type(self, reported: tuple[int, int], now: float, channel: str) -> Finding:
        """Check the type and autopilot of a HEARTBEAT."""
        self._record_channel(now, channel)
        seen, before = self._types.get(reported), self._type
        _record(self._types, reported, now, channel)
        if before is None or reported == before:
            self._type = reported
            return self._check_boards(now)
        self._type = reported
        if seen is None or now - seen.at > MAX_PATH_DELAY:
            self._alternations = 0
            return self._check_boards(now)
        self._alternations += 1
        return self._begin("type", now) if self._alternations >= MIN_ALTERNATIONS else Finding.NOTHING

    def observe_version(self, version: AutopilotVersion, now: float, channel: str) -> Finding:
        """Check the unique id of an AUTOPILOT_VERSION; an empty one contradicts none."""
        self._record_channel(now, channel, names_board=True)
        self._boards.report(version, now, channel)
        return self._check_boards(now)

    def last_seen(self, reported: tuple[int, int]) -> float | None:
        """Return when a HEARTBEAT with that type and autopilot was last received, Unix seconds."""
        seen = self._types.get(reported)
        return None if seen is None else seen.at

    def conflict(self, now: float) -> Conflict | None:
        """Return the senders that use the address and what tells them apart; None without a conflict."""
        if not self.in_conflict:
            return None
        return Conflict(self._senders(now), tuple(sorted(self._contradicted)))

    def _senders(self, now: float) -> tuple[ConflictingSender, ...]:
        """Return the senders, told apart by type, unique id, boot or channel, in this order."""
        types = _recent(self._types, now)
        if len(types) > 1:
            return tuple(self._sender(each, tuple(seen.channels)) for each, seen in types.items())
        known = next(iter(types), None)
        boards = self._boards.interleaved(now)
        if boards:
            return tuple(
                self._sender(known, tuple(board.channels), unique_id=board.unique_id) for board in boards
            )
        boots = [
            boot
            for boot in self.boot_tracker.boots
            if now - boot.seen_at < CONFLICT_ENDS_AFTER and not boot.is_path
        ]
        if len(boots) > 1:
            return tuple(self._sender(known, tuple(boot.channels), boot.booted_at) for boot in boots)
        heard = [name for name, each in self._heard.items() if now - each.at < CONFLICT_ENDS_AFTER]
        names = heard if len(heard) > 1 else [*heard, *heard]
        return tuple(self._sender(known, (name,)) for name in names)

    def _sender(
        self,
        reported: tuple[int, int] | None,
        channels: tuple[str, ...],
        booted_at: float | None = None,
        *,
        unique_id: str = "",
    ) -> ConflictingSender:
        """Return what is known of a sender; a channel that it has alone tells more of it."""
        channels = tuple(filter(None, channels))
        heard = self._heard.get(channels[0]) if len(channels) == 1 else None
        board = self._boards.on(channels[0]) if len(channels) == 1 else None
        return ConflictingSender(
            reported,
            booted_at if booted_at is not None or heard is None else heard.booted_at,
            unique_id or (board.unique_id if board else ""),
            channels,
            heard.position if heard else None,
        )

    def _record_channel(self, now: float, channel: str, *, names_board: bool = False) -> _Heard:
        heard = self._heard.get(channel)
        if heard is None or now - heard.at >= CHANNEL_SILENCE:
            if heard is None and len(self._heard) >= MAX_CHANNELS:
                del self._heard[min(self._heard, key=lambda name: self._heard[name].at)]
            heard = self._heard[channel] = _Heard(now, now)
        heard.at = now
        if not names_board:
            self._boards.heard(now, channel)
        return heard

    def _forget_boot(self) -> None:
        """Forget what the boot before showed."""
        self._states.clear()
        for channel in tuple(self._heard):
            self._clocks.forget_channel(channel)

    def _check_boards(self, now: float) -> Finding:
        if self._boards.interleaved(now):
            return self._begin("unique id", now)
        return self._end(now) if self.in_conflict else Finding.NOTHING

    def _begin(self, differs: str, now: float) -> Finding:
        self._contradicted[differs] = now
        if self.in_conflict:
            return Finding.NOTHING
        self.in_conflict = True
        return Finding.CONFLICT

    def _end(self, now: float) -> Finding:
        if self.boot_tracker.in_conflict:
            return Finding.NOTHING
        ended = [kind for kind, at in self._contradicted.items() if now - at >= CONFLICT_ENDS_AFTER]
        for kind in ended:
            del self._contradicted[kind]
        if self._contradicted:
            return Finding.NOTHING
        self.in_conflict, self._alternations = False, 0
        self._types = _recent(self._types, now)
        return Finding.CONFLICT_ENDED


def _record(register: dict[Key, _Seen], key: Key, now: float, channel: str) -> None:
    seen = register.get(key)
    if seen is None:
        if len(register) >= MAX_SENDERS:
            del register[min(register, key=lambda known: register[known].at)]
        seen = register[key] = _Seen(now)
    seen.at = now
    if channel and len(seen.channels) < MAX_CHANNELS:
        seen.channels[channel] = None


def _recent(register: dict[Key, _Seen], now: float) -> dict[Key, _Seen]:
    return {key: seen for key, seen in register.items() if now - seen.at < CONFLICT_ENDS_AFTER}
