"""The tracker of the boots of one address: reboots, several links, or several senders (see the package)."""

from __future__ import annotations

from enum import Enum, auto

#: Seconds by which the boot times computed from messages of one boot may differ.
SAME_BOOT = 3.0
#: Seconds by which the delays of two links to one vehicle may differ, and so the boot times computed from
#: them.
MAX_PATH_DELAY = 10.0
#: The shortest boot of any autopilot in seconds; after a longer gap between two messages the sender may have
#: rebooted.
MIN_BOOT_DURATION = 1.0
#: Seconds without a message of a boot after which it has ended, if messages of another boot still arrive.
BOOT_SILENCE = 3.0
#: Seconds for which messages of two boots must arrive side by side to show a conflict; packets sent before a
#: reboot do not stay in queues for so long.
CONFLICT_AFTER = 10.0
#: The same time, if messages of the older boot were surely sent after the later boot.
CONCURRENT_AFTER = 2.0
#: The number of messages of each boot that must have arrived in this time.
MIN_MESSAGES = 3
#: Seconds with messages of only one boot after which a conflict is over.
CONFLICT_ENDS_AFTER = 30.0
MAX_BOOTS = 4
MAX_CHANNELS = 8
_WRAP = 4294967.296


class Finding(Enum):
    """The conclusion from one message."""

    NOTHING = auto()
    REBOOTED = auto()
    CONFLICT = auto()
    CONFLICT_ENDED = auto()


class Boot:
    """One boot of a sender, and the messages since then."""

    __slots__ = (
        "began_at",
        "channels",
        "is_path",
        "is_reboot",
        "messages",
        "moment",
        "others",
        "seen_at",
        "since_boot",
    )

    def __init__(self, since_boot: float, now: float) -> None:
        self.since_boot, self.seen_at, self.began_at = since_boot, now, now
        self.moment = now - since_boot  # the local time of the boot, from the message with the least delay
        self.messages = self.others = 0  # messages of this boot, and of the current boot in the same time
        self.is_reboot = False  # True if this boot can follow the current one
        self.is_path = False  # True if this is the current boot, received over another link
        self.channels: dict[str, None] = {}

    @property
    def booted_at(self) -> float:
        """The latest possible boot time, Unix seconds."""
        return self.seen_at - self.since_boot

    def deviation(self, since_boot: float, now: float) -> float:
        """Return the seconds by which a message deviates; negative if its sender booted later."""
        off = since_boot - self.since_boot - (now - self.seen_at)
        return off if -_WRAP / 2 < off <= _WRAP / 2 else (off + _WRAP / 2) % _WRAP - _WRAP / 2


class BootTracker:
    """The tracker of `time_boot_ms` of one address."""

    def __init__(self) -> None:
        self.in_conflict = False
        self._boots: list[Boot] = []
        self._current: Boot | None = None
        self._other_seen_at = 0.0

    @property
    def boots(self) -> tuple[Boot, ...]:
        """The tracked boots, the current one first."""
        return tuple(sorted(self._boots, key=lambda boot: boot is not self._current))

    def observe(self, time_boot_ms: int, now: float, channel: str = "") -> Finding:
        """Track the boot time of a message, received on `channel`."""
        since_boot, current = time_boot_ms / 1000, self._current
        if current is None:
            current = self._current = self._add(since_boot, now)
        if abs(current.deviation(since_boot, now)) <= SAME_BOOT:
            if not self.in_conflict and _rebooted_early(current, since_boot, now):
                boot = self._add(since_boot, now)
                _record(boot, since_boot, now, channel)
                return self._switch_to(boot, Finding.REBOOTED)
            _record(current, since_boot, now, channel)
            return self._current_received(current, now) if len(self._boots) > 1 else Finding.NOTHING
        silence = now - self._current_seen_at()
        fits = [boot for boot in self._boots if abs(boot.deviation(since_boot, now)) <= SAME_BOOT]
        boot = fits[0] if fits else self._add_other(since_boot, now, current)
        _record(boot, since_boot, now, channel)
        if self.in_conflict:
            return self._update_conflict(boot, now)
        return Finding.NOTHING if boot.is_path else self._compare(boot, current, silence, now)

    def note_expected(self, time_boot_ms: int, seen_at: float, channel: str) -> None:
        """Record the last message of the current boot; one of another boot, or an old one, is ignored."""
        current, since_boot = self._current, time_boot_ms / 1000
        if current is None or seen_at <= current.seen_at:
            return
        if abs(current.deviation(since_boot, seen_at)) <= SAME_BOOT:
            _record(current, since_boot, seen_at, channel)

    def _add_other(self, since_boot: float, now: float, current: Boot) -> Boot:
        """Add a boot beside the current one."""
        if len(self._boots) >= MAX_BOOTS:
            others = (boot for boot in self._boots if boot is not current)
            self._boots.remove(min(others, key=lambda boot: boot.seen_at))
        boot = self._add(since_boot, now)
        off, further = current.deviation(since_boot, now), since_boot - current.since_boot
        boot.is_reboot = off < 0 and (further < 0 or (off < -MAX_PATH_DELAY and further > SAME_BOOT))
        return boot

    def _add(self, since_boot: float, now: float) -> Boot:
        boot = Boot(since_boot, now)
        self._boots.append(boot)
        return boot

    def _current_seen_at(self) -> float:
        """Return the time of the last message of the current boot over any link."""
        return max(boot.seen_at for boot in self._boots if boot is self._current or boot.is_path)

    def _compare(self, boot: Boot, current: Boot, silence: float, now: float) -> Finding:
        """Conclude from a message of another boot than the current one."""
        short = boot.since_boot <= silence + MAX_PATH_DELAY
        if silence >= BOOT_SILENCE or (
            boot.messages == 1 and boot.is_reboot and short and silence >= MIN_BOOT_DURATION
        ):
            return self._switch_to(boot, Finding.REBOOTED if boot.is_reboot else Finding.NOTHING)
        if min(boot.messages, boot.others) >= MIN_MESSAGES and abs(_gap(boot, current)) <= MAX_PATH_DELAY:
            boot.is_path = True
        return self._check_conflict(boot, current, now)

    def _switch_to(self, boot: Boot, finding: Finding) -> Finding:
        self._current, self._boots = boot, [boot]
        return finding

    def _current_received(self, current: Boot, now: float) -> Finding:
        if self.in_conflict:
            return self._update_conflict(current, now)
        self._boots = [
            boot for boot in self._boots if boot is current or now - boot.seen_at < CONFLICT_ENDS_AFTER
        ]
        for boot in self._boots:
            boot.others += 1
            if not boot.is_path and self._check_conflict(boot, current, now) is Finding.CONFLICT:
                return Finding.CONFLICT
        return Finding.NOTHING

    def _check_conflict(self, boot: Boot, current: Boot, now: float) -> Finding:
        """Conclude whether another boot has continued for long beside the current one."""
        together = min(current.seen_at, boot.seen_at) - boot.began_at
        needed = CONCURRENT_AFTER if _are_concurrent(boot, current) else CONFLICT_AFTER
        often = min(boot.messages, boot.others) >= MIN_MESSAGES
        if boot is current or together < needed or not often or abs(_gap(boot, current)) <= MAX_PATH_DELAY:
            return Finding.NOTHING
        self.in_conflict, self._other_seen_at = True, now
        return Finding.CONFLICT

    def _update_conflict(self, boot: Boot, now: float) -> Finding:
        if boot is not self._current:
            self._other_seen_at = now
        if (
            now - self._current_seen_at() < CONFLICT_ENDS_AFTER
            and now - self._other_seen_at < CONFLICT_ENDS_AFTER
        ):
            return Finding.NOTHING
        self.in_conflict = False
        return self._switch_to(boot, Finding.CONFLICT_ENDED)


def _record(boot: Boot, since_boot: float, now: float, channel: str) -> None:
    boot.since_boot, boot.seen_at = since_boot, now
    boot.moment = min(boot.moment, now - since_boot)
    boot.messages += 1
    if channel and len(boot.channels) < MAX_CHANNELS:
        boot.channels[channel] = None


def _gap(boot: Boot, current: Boot) -> float:
    """Return the seconds between two boots; negative if the first is the later one."""
    return current.deviation(boot.since_boot, boot.seen_at)


def _are_concurrent(boot: Boot, current: Boot) -> bool:
    """Return whether the older boot sent messages after the later one, whatever their delays are."""
    older, later = sorted((boot, current), key=lambda each: each.moment)
    return older.moment + older.since_boot > later.moment + MAX_PATH_DELAY


def _rebooted_early(current: Boot, since_boot: float, now: float) -> bool:
    """Return whether a sender rebooted shortly after it had booted: then the two boots are close together."""
    silence = now - current.seen_at
    return since_boot < current.since_boot and silence >= MIN_BOOT_DURATION and since_boot <= silence
