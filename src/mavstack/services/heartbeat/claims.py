"""Who claims an address: what its messages tell about their sender, and whether that can be one.

Three things tell two senders of one address apart, as no number in a packet does:

    their lives           two starts that both go on (see `lives`)
    their kinds           HEARTBEAT's type and autopilot go to and fro; what changes once was set up anew
    their unique ids      two different ones within seconds (AUTOPILOT_VERSION): no board is changed so fast

Two vehicles of one kind that were started at the same moment, whose versions nobody asks for, stay one. Over
two channels each, the claims name where each was heard.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

from mavstack.services.heartbeat.kinds import describe_kind
from mavstack.services.heartbeat.lives import APART, MOST_CHANNELS, OVER, Lives, Verdict

Key = TypeVar("Key")

#: So often a kind must come back after another one.
RETURNS = 2
MOST_CLAIMS = 4


@dataclass(frozen=True, slots=True)
class Claim:
    """What is known of one of those who use an address; `kind` is HEARTBEAT's type and autopilot."""

    kind: tuple[int, int] | None = None
    booted_at: float | None = None
    unique_id: str = ""
    channels: tuple[str, ...] = ()

    def __str__(self) -> str:
        words = [describe_kind(*self.kind) if self.kind else "something"]
        if self.unique_id:
            words.append(f"with the id {self.unique_id}")
        if self.channels:
            words.append(f"on {', '.join(self.channels)}")
        return " ".join(words)


@dataclass(slots=True)
class _Seen:
    """One kind or unique id, and where it was heard."""

    heard_at: float
    channels: dict[str, None] = field(default_factory=dict)


class Claims:
    """What the senders of one address tell of themselves."""

    __slots__ = ("_ids", "_kind", "_kinds", "_returns", "_told_at", "clashing", "lives")

    def __init__(self) -> None:
        self.lives = Lives()
        self.clashing = False
        self._kind: tuple[int, int] | None = None
        self._kinds: dict[tuple[int, int], _Seen] = {}
        self._ids: dict[str, _Seen] = {}
        self._returns = 0
        self._told_at = 0.0  # when what they tell last contradicted itself

    @property
    def undisputed(self) -> bool:
        """Whether only one life of one sender is followed."""
        return not self.clashing and len(self.lives.all) == 1

    def boot_time(self, time_boot_ms: int, now: float, channel: str) -> Verdict:
        """A message told the time since its sender's start."""
        verdict = self.lives.observe(time_boot_ms, now, channel)
        if verdict is Verdict.REBOOTED:
            return Verdict.NOTHING if self.clashing else verdict
        if verdict is Verdict.CLASH:
            return self._clash(now)
        return self._end(now) if self.clashing else Verdict.NOTHING

    def kind(self, kind: tuple[int, int], now: float, channel: str) -> Verdict:
        """A HEARTBEAT told a type and an autopilot."""
        seen, before = self._kinds.get(kind), self._kind
        _see(self._kinds, kind, now, channel)
        if before is None or kind == before:
            self._kind = kind
            return self._end(now) if self.clashing else Verdict.NOTHING
        self._kind = kind
        if seen is None or now - seen.heard_at > APART:
            self._returns = 0
            return Verdict.NOTHING
        self._returns += 1
        return self._clash(now) if self._returns >= RETURNS else Verdict.NOTHING

    def unique_id(self, unique_id: str, now: float, channel: str) -> Verdict:
        """An AUTOPILOT_VERSION told a unique id."""
        if not unique_id:
            return Verdict.NOTHING
        _see(self._ids, unique_id, now, channel)
        others = [seen for known, seen in self._ids.items() if known != unique_id]
        return self._clash(now) if any(now - seen.heard_at < APART for seen in others) else Verdict.NOTHING

    def heard_as(self, kind: tuple[int, int]) -> float | None:
        """When a sender of that kind was last heard."""
        seen = self._kinds.get(kind)
        return None if seen is None else seen.heard_at

    def all(self, now: float) -> tuple[Claim, ...]:
        """Those who use the address, by what tells them apart best."""
        kinds, ids = _recent(self._kinds, now), _recent(self._ids, now)
        if len(kinds) > 1:
            return tuple(Claim(kind, channels=tuple(seen.channels)) for kind, seen in kinds.items())
        kind = next(iter(kinds), None)
        if len(ids) > 1:
            return tuple(Claim(kind, unique_id=each, channels=tuple(ids[each].channels)) for each in ids)
        lives = [life for life in self.lives.all if now - life.heard_at < OVER and not life.is_path]
        return tuple(Claim(kind, life.booted_at, channels=tuple(life.channels)) for life in lives)

    def _clash(self, now: float) -> Verdict:
        self._told_at = now
        if self.clashing:
            return Verdict.NOTHING
        self.clashing = True
        return Verdict.CLASH

    def _end(self, now: float) -> Verdict:
        if self.lives.clashing or now - self._told_at < OVER:
            return Verdict.NOTHING
        self.clashing, self._returns = False, 0
        self._kinds, self._ids = _recent(self._kinds, now), _recent(self._ids, now)
        return Verdict.CLASH_OVER


def _see(register: dict[Key, _Seen], key: Key, now: float, channel: str) -> None:
    seen = register.get(key)
    if seen is None:
        if len(register) >= MOST_CLAIMS:
            del register[min(register, key=lambda known: register[known].heard_at)]
        seen = register[key] = _Seen(now)
    seen.heard_at = now
    if channel and len(seen.channels) < MOST_CHANNELS:
        seen.channels[channel] = None


def _recent(register: dict[Key, _Seen], now: float) -> dict[Key, _Seen]:
    return {key: seen for key, seen in register.items() if now - seen.heard_at < OVER}
