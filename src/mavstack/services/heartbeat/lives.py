"""The lives that one address leads: a reboot, two vehicles with one address, or one vehicle over two links.

What a message tells of the time since its sender's start says when that was: a *life* is all that fits one
start. Delays, reordering and a clock that runs faster or slower than ours move it a little at a time, so a
life is followed, and a message belongs to it if it is no further off than `SAME`. A message that fits no life
begins another one. What that means, what comes next tells:

    the other life was silent, and the new one is no longer than that silence    a reboot, told at once
    the other life is silent from then on for `SETTLED`                          a reboot, told then
    both go on, and their starts are less than `APART` apart                     one vehicle, over two links
    both go on for `TOGETHER`                                                    a clash: two vehicles

A new life that would have begun before the old one is no reboot: a clock jumped, or the machine slept. Nor is
one that goes on where the old one stopped (a simulator was halted), nor one that came late out of a queue. So
a reboot is seen even if the vehicle has been up for longer than before when it is heard again, and a second
vehicle that is switched on beside the first is not told as its reboot.

Two vehicles that were started within `APART` of each other cannot be told apart by this; see `claims`.
"""

from __future__ import annotations

from enum import Enum, auto

#: How far off the time of a message of one life may be, in seconds.
SAME = 3.0
#: Delays of two ways from one vehicle differ by less, and so do the starts that they tell.
APART = 10.0
#: No autopilot starts within this time; a message more than this after the last is a silence.
SILENCE = 1.0
#: After so long a silence a life is over, if another one goes on.
SETTLED = 3.0
#: So long two lives must go on beside each other, longer than messages of before a reboot stay on their way.
TOGETHER = 10.0
#: How many messages of each life must have come meanwhile.
EVIDENCE = 3
#: A clash is over when only one life was heard for so long.
OVER = 30.0
MOST_LIVES = 4
MOST_CHANNELS = 8
_WRAP = 4294967.296


class Verdict(Enum):
    """What a message shows."""

    NOTHING = auto()
    REBOOTED = auto()
    CLASH = auto()
    CLASH_OVER = auto()


class Life:
    """One start, and what came since."""

    __slots__ = ("began_at", "channels", "heard", "heard_at", "is_path", "is_start", "others", "since_boot")

    def __init__(self, since_boot: float, now: float) -> None:
        self.since_boot, self.heard_at, self.began_at = since_boot, now, now
        self.heard = self.others = 0  # messages of it, and of the current life meanwhile
        self.is_start = False  # it can be what follows on the current one
        self.is_path = False  # it is the current one over another link
        self.channels: dict[str, None] = {}

    @property
    def booted_at(self) -> float:
        """When it started, as our clock tells it, at the latest."""
        return self.heard_at - self.since_boot

    def is_off_by(self, since_boot: float, now: float) -> float:
        """How far a message is from being of this life; negative if its sender started later."""
        off = since_boot - self.since_boot - (now - self.heard_at)
        return off if -_WRAP / 2 < off <= _WRAP / 2 else (off + _WRAP / 2) % _WRAP - _WRAP / 2


class Lives:
    """Follows `time_boot_ms` of one address."""

    def __init__(self) -> None:
        self.clashing = False
        self._lives: list[Life] = []
        self._current: Life | None = None
        self._other_heard_at = 0.0

    @property
    def all(self) -> tuple[Life, ...]:
        """The lives that are followed, the current one first."""
        return tuple(sorted(self._lives, key=lambda life: life is not self._current))

    def observe(self, time_boot_ms: int, now: float, channel: str = "") -> Verdict:
        """Take in the time of a message; `channel` is where it came from."""
        since_boot, current = time_boot_ms / 1000, self._current
        if current is None:
            current = self._current = self._begun(since_boot, now)
        if abs(current.is_off_by(since_boot, now)) <= SAME:
            if not self.clashing and _starts_soon(current, since_boot, now):
                life = self._begun(since_boot, now)
                _heard(life, since_boot, now, channel)
                return self._begins(life, Verdict.REBOOTED)
            _heard(current, since_boot, now, channel)
            return self._current_heard(current, now) if len(self._lives) > 1 else Verdict.NOTHING
        silence = now - self._last_heard_at()
        fits = [life for life in self._lives if abs(life.is_off_by(since_boot, now)) <= SAME]
        life = fits[0] if fits else self._follow(since_boot, now, current)
        _heard(life, since_boot, now, channel)
        if self.clashing:
            return self._clash_goes_on(life, now)
        return Verdict.NOTHING if life.is_path else self._judge(life, current, silence, now)

    def _follow(self, since_boot: float, now: float, current: Life) -> Life:
        """Begin to follow another life."""
        if len(self._lives) >= MOST_LIVES:
            others = (life for life in self._lives if life is not current)
            self._lives.remove(min(others, key=lambda life: life.heard_at))
        life = self._begun(since_boot, now)
        off, further = current.is_off_by(since_boot, now), since_boot - current.since_boot
        life.is_start = off < 0 and (further < 0 or (off < -APART and further > SAME))
        return life

    def _begun(self, since_boot: float, now: float) -> Life:
        life = Life(since_boot, now)
        self._lives.append(life)
        return life

    def _last_heard_at(self) -> float:
        """When the current life was last heard, whichever way."""
        return max(life.heard_at for life in self._lives if life is self._current or life.is_path)

    def _judge(self, life: Life, current: Life, silence: float, now: float) -> Verdict:
        """What another life than the current one means."""
        short = life.since_boot <= silence + APART
        if silence >= SETTLED or (life.heard == 1 and life.is_start and short and silence >= SILENCE):
            return self._begins(life, Verdict.REBOOTED if life.is_start else Verdict.NOTHING)
        if min(life.heard, life.others) >= EVIDENCE and abs(_gap(life, current)) <= APART:
            life.is_path = True
        return self._judge_clash(life, current, now)

    def _begins(self, life: Life, verdict: Verdict) -> Verdict:
        self._current, self._lives = life, [life]
        return verdict

    def _current_heard(self, current: Life, now: float) -> Verdict:
        if self.clashing:
            return self._clash_goes_on(current, now)
        self._lives = [life for life in self._lives if life is current or now - life.heard_at < OVER]
        for life in self._lives:
            life.others += 1
            if not life.is_path and self._judge_clash(life, current, now) is Verdict.CLASH:
                return Verdict.CLASH
        return Verdict.NOTHING

    def _judge_clash(self, life: Life, current: Life, now: float) -> Verdict:
        """Whether another life has gone on for long beside the current one."""
        together = min(current.heard_at, life.heard_at) - life.began_at
        often = min(life.heard, life.others) >= EVIDENCE
        if life is current or together < TOGETHER or not often or abs(_gap(life, current)) <= APART:
            return Verdict.NOTHING
        self.clashing, self._other_heard_at = True, now
        return Verdict.CLASH

    def _clash_goes_on(self, heard: Life, now: float) -> Verdict:
        if heard is not self._current:
            self._other_heard_at = now
        if now - self._last_heard_at() < OVER and now - self._other_heard_at < OVER:
            return Verdict.NOTHING
        self.clashing = False
        return self._begins(heard, Verdict.CLASH_OVER)


def _heard(life: Life, since_boot: float, now: float, channel: str) -> None:
    life.since_boot, life.heard_at = since_boot, now
    life.heard += 1
    if channel and len(life.channels) < MOST_CHANNELS:
        life.channels[channel] = None


def _gap(life: Life, current: Life) -> float:
    """How much later one life began than another, counted negative."""
    return current.is_off_by(life.since_boot, life.heard_at)


def _starts_soon(current: Life, since_boot: float, now: float) -> bool:
    """Whether a vehicle that had hardly started did so again: then the two starts are close together."""
    silence = now - current.heard_at
    return since_boot < current.since_boot and silence >= SILENCE and since_boot <= silence
