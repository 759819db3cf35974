"""A model of a bad radio link, one direction of it: bytes in, bytes out, and the caller owns the time.

A chunk that is sent at `now` goes through these steps, each by its own chance:

1. bandwidth: chunks leave one behind the other at so many bytes a second; one that would make the queue in
   front of the transmitter longer than `queue` bytes is dropped;
2. loss: it took its time on the air and is gone;
3. corruption: each byte may have bits flipped;
4. latency, and up to `jitter` more or less; chunks stay in order,
5. except one that is reordered: it is held back up to `hold` longer while later ones pass it.

A duplicated chunk goes through all steps twice. The same seed and the same calls give the same result.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from heapq import heappop, heappush
from itertools import count
from random import Random
from typing import TYPE_CHECKING, Self

from mavstack.errors import LinkURLError

if TYPE_CHECKING:
    from mavstack.links.options import Options


@dataclass(frozen=True, slots=True, kw_only=True)
class Impairment:
    """How bad: probabilities for each chunk (`corrupt`: for each byte), seconds, and bytes a second."""

    loss: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0
    corrupt: float = 0.0
    latency: float = 0.0
    jitter: float = 0.0
    hold: float = 0.1
    bandwidth: float = 0.0  # bytes a second; 0 is without limit
    queue: int = 1 << 16
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("loss", "duplicate", "reorder", "corrupt"):
            if not 0 <= getattr(self, name) <= 1:
                raise LinkURLError(f"{name} must be between 0 and 1, not {getattr(self, name)}")
        for name in ("latency", "jitter", "hold", "bandwidth", "queue"):
            if not 0 <= getattr(self, name) < math.inf:
                raise LinkURLError(f"{name} must be zero or more, not {getattr(self, name)}")

    @classmethod
    def from_options(cls, options: Options) -> Self | None:
        """What a link's URL asks for; None if it asks for nothing."""
        given = [field.name for field in fields(cls) if options.has(field.name)]
        if not given:
            return None
        return cls(
            loss=options.fraction("loss", 0.0),
            duplicate=options.fraction("duplicate", 0.0),
            reorder=options.fraction("reorder", 0.0),
            corrupt=options.fraction("corrupt", 0.0),
            latency=options.seconds("latency", 0.0),
            jitter=options.seconds("jitter", 0.0),
            hold=options.seconds("hold", 0.1),
            bandwidth=options.size("bandwidth", 0),
            queue=options.size("queue", 1 << 16),
            seed=options.whole("seed", 0, lowest=0),
        )


@dataclass(slots=True)
class FlowStats:
    """What happened to the chunks of one flow."""

    sent: int = 0
    delivered: int = 0
    lost: int = 0
    overflowed: int = 0
    duplicated: int = 0
    reordered: int = 0
    corrupted: int = 0


class Flow:
    """One direction of one impaired channel; `name` keeps flows of the same seed from being alike."""

    def __init__(self, impairment: Impairment, name: str = "") -> None:
        self.stats = FlowStats()
        self._model = impairment
        self._random = Random(f"{impairment.seed}/{name}")
        self._free_at = -math.inf  # when the transmitter has sent all it has
        self._last_due = -math.inf
        self._order = count()
        self._on_the_way: list[tuple[float, int, bytes]] = []

    def send(self, data: bytes, now: float) -> bool:
        """Send a chunk; False if there was no room for it. A loss on the air is not told."""
        self.stats.sent += 1
        accepted = self._transmit(data, now)
        if self._happens(self._model.duplicate):
            self.stats.duplicated += 1
            self._transmit(data, now)
        return accepted

    def receive(self, now: float) -> list[bytes]:
        """The chunks that have arrived by now."""
        arrived = []
        while self._on_the_way and self._on_the_way[0][0] <= now:
            arrived.append(heappop(self._on_the_way)[2])
        self.stats.delivered += len(arrived)
        return arrived

    def next_timeout(self) -> float | None:
        """When the next chunk arrives; None if nothing is on the way."""
        return self._on_the_way[0][0] if self._on_the_way else None

    def _transmit(self, data: bytes, now: float) -> bool:
        departure = self._depart(len(data), now)
        if departure is None:
            self.stats.overflowed += 1
            return False
        if self._happens(self._model.loss):
            self.stats.lost += 1
        else:
            heappush(self._on_the_way, (self._arrival(departure), next(self._order), self._corrupt(data)))
        return True

    def _depart(self, size: int, now: float) -> float | None:
        """When the last byte leaves the transmitter; None if the queue before it is full."""
        bandwidth = self._model.bandwidth
        if not bandwidth:
            return now
        begin = max(now, self._free_at)
        if begin > now and (begin - now) * bandwidth + size > self._model.queue:
            return None
        self._free_at = begin + size / bandwidth
        return self._free_at

    def _arrival(self, departure: float) -> float:
        model = self._model
        delay = model.latency + (self._random.uniform(-model.jitter, model.jitter) if model.jitter else 0.0)
        due = max(departure + max(delay, 0.0), self._last_due)
        if self._happens(model.reorder):
            self.stats.reordered += 1
            return due + self._random.uniform(0.0, model.hold)
        self._last_due = due
        return due

    def _corrupt(self, data: bytes) -> bytes:
        """Flip bits; the distance to the next bad byte is drawn, not a chance for each byte."""
        chance = self._model.corrupt
        if not chance:
            return data
        damaged = bytearray(data)
        position = self._distance(chance)
        while position < len(damaged):
            damaged[position] ^= self._random.randrange(1, 256)
            position += 1 + self._distance(chance)
        self.stats.corrupted += damaged != data
        return bytes(damaged)

    def _distance(self, chance: float) -> int:
        if chance >= 1:
            return 0
        return int(min(math.log1p(-self._random.random()) / math.log1p(-chance), 1e9))

    def _happens(self, chance: float) -> bool:
        return chance > 0 and self._random.random() < chance
