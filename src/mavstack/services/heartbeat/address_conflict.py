"""The detector of several senders with one address (see the package)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

from mavstack.services.heartbeat.boot_tracker import (
    CONFLICT_ENDS_AFTER,
    MAX_CHANNELS,
    MAX_PATH_DELAY,
    BootTracker,
    Finding,
)
from mavstack.services.heartbeat.component_types import describe_component

Key = TypeVar("Key")

#: How often a type must alternate with another one.
MIN_ALTERNATIONS = 2
MAX_SENDERS = 4


@dataclass(frozen=True, slots=True)
class ConflictingSender:
    """One of several senders that use an address.

    Attributes:
        type_and_autopilot: Its MAV_TYPE and MAV_AUTOPILOT, if it sent a HEARTBEAT.
        booted_at: When it booted, Unix seconds, if the boot times tell the senders apart.
        unique_id: Its unique id in hexadecimal, if the unique ids tell the senders apart.
        channels: The names of the channels over which it was received.
    """

    type_and_autopilot: tuple[int, int] | None = None
    booted_at: float | None = None
    unique_id: str = ""
    channels: tuple[str, ...] = ()

    def __str__(self) -> str:
        known = self.type_and_autopilot
        words = [describe_component(*known) if known else "unknown component"]
        if self.unique_id:
            words.append(f"with the id {self.unique_id}")
        if self.channels:
            words.append(f"on {', '.join(self.channels)}")
        return " ".join(words)


@dataclass(slots=True)
class _Seen:
    """When and on which channels one type or unique id was received."""

    at: float
    channels: dict[str, None] = field(default_factory=dict)


class AddressConflictDetector:
    """The detector for one address; it owns the address's boot tracker."""

    __slots__ = (
        "_alternations",
        "_contradicted_at",
        "_ids",
        "_type",
        "_types",
        "boot_tracker",
        "in_conflict",
    )

    def __init__(self) -> None:
        self.boot_tracker = BootTracker()
        self.in_conflict = False
        self._type: tuple[int, int] | None = None
        self._types: dict[tuple[int, int], _Seen] = {}
        self._ids: dict[str, _Seen] = {}
        self._alternations = 0
        self._contradicted_at = 0.0

    @property
    def is_one_boot(self) -> bool:
        """True while all messages come from one boot of one sender."""
        return not self.in_conflict and len(self.boot_tracker.boots) == 1

    def observe_boot_time(self, time_boot_ms: int, now: float, channel: str) -> Finding:
        """Check the boot time of a message."""
        finding = self.boot_tracker.observe(time_boot_ms, now, channel)
        if finding is Finding.REBOOTED:
            return Finding.NOTHING if self.in_conflict else finding
        if finding is Finding.CONFLICT:
            return self._begin(now)
        return self._end(now) if self.in_conflict else Finding.NOTHING

    def observe_type(self, reported: tuple[int, int], now: float, channel: str) -> Finding:
        """Check the type and autopilot of a HEARTBEAT."""
        seen, before = self._types.get(reported), self._type
        _record(self._types, reported, now, channel)
        if before is None or reported == before:
            self._type = reported
            return self._end(now) if self.in_conflict else Finding.NOTHING
        self._type = reported
        if seen is None or now - seen.at > MAX_PATH_DELAY:
            self._alternations = 0
            return Finding.NOTHING
        self._alternations += 1
        return self._begin(now) if self._alternations >= MIN_ALTERNATIONS else Finding.NOTHING

    def observe_unique_id(self, unique_id: str, now: float, channel: str) -> Finding:
        """Check the unique id of an AUTOPILOT_VERSION; an empty one contradicts none."""
        if not unique_id:
            return Finding.NOTHING
        _record(self._ids, unique_id, now, channel)
        others = [seen for known, seen in self._ids.items() if known != unique_id]
        return self._begin(now) if any(now - seen.at < MAX_PATH_DELAY for seen in others) else Finding.NOTHING

    def last_seen(self, reported: tuple[int, int]) -> float | None:
        """Return when a HEARTBEAT with that type and autopilot was last received, Unix seconds."""
        seen = self._types.get(reported)
        return None if seen is None else seen.at

    def senders(self, now: float) -> tuple[ConflictingSender, ...]:
        """Return the senders that use the address, told apart by type, unique id or boot, in this order."""
        types, ids = _recent(self._types, now), _recent(self._ids, now)
        if len(types) > 1:
            return tuple(
                ConflictingSender(each, channels=tuple(seen.channels)) for each, seen in types.items()
            )
        known = next(iter(types), None)
        if len(ids) > 1:
            return tuple(
                ConflictingSender(known, unique_id=each, channels=tuple(seen.channels))
                for each, seen in ids.items()
            )
        boots = [
            boot
            for boot in self.boot_tracker.boots
            if now - boot.seen_at < CONFLICT_ENDS_AFTER and not boot.is_path
        ]
        return tuple(
            ConflictingSender(known, boot.booted_at, channels=tuple(boot.channels)) for boot in boots
        )

    def _begin(self, now: float) -> Finding:
        self._contradicted_at = now
        if self.in_conflict:
            return Finding.NOTHING
        self.in_conflict = True
        return Finding.CONFLICT

    def _end(self, now: float) -> Finding:
        if self.boot_tracker.in_conflict or now - self._contradicted_at < CONFLICT_ENDS_AFTER:
            return Finding.NOTHING
        self.in_conflict, self._alternations = False, 0
        self._types, self._ids = _recent(self._types, now), _recent(self._ids, now)
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
