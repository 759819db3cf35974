"""A sans-IO model of one direction of a lossy link: chunks in, delayed or damaged chunks out.

A chunk that is sent at `now` passes these steps, each with its own probability:

1. bandwidth: chunks are transmitted one after the other at `bandwidth` bytes per second; a chunk that would
   exceed the transmitter's queue of `queue` bytes is dropped;
2. loss: the chunk takes its transmission time, but never arrives;
3. corruption: each byte may have flipped bits;
4. delay: `latency`, plus or minus up to `jitter`; chunks stay in order;
5. reordering: a reordered chunk is delayed by up to `hold` more, so that later chunks overtake it.

A duplicated chunk passes all steps twice. The same seed and the same calls give the same result.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from heapq import heappop, heappush
from itertools import count
from typing import TYPE_CHECKING, Self

from mavstack.errors import InvalidArgumentError
from mavstack.links.impairment_profiles import PROFILES

if TYPE_CHECKING:
    from mavstack.links.options import Options


@dataclass(frozen=True, slots=True, kw_only=True)
class Impairment:
    """The parameters of an impaired link.

    Attributes:
        loss: Probability that a chunk is lost, 0 to 1.
        duplicate: Probability that a chunk is sent twice, 0 to 1.
        reorder: Probability that a chunk is overtaken by later ones, 0 to 1.
        corrupt: Probability that a byte is changed, 0 to 1.
        latency: Delay of each chunk in seconds.
        jitter: Maximum deviation from the latency in seconds.
        hold: Maximum additional delay of a reordered chunk in seconds.
        bandwidth: Bytes per second; 0 is unlimited.
        queue: Maximum number of bytes waiting for transmission.
        seed: Seed of the random decisions.

    Raises:
        InvalidArgumentError: A value is out of range.
    """

    loss: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0
    corrupt: float = 0.0
    latency: float = 0.0
    jitter: float = 0.0
    hold: float = 0.1
    bandwidth: float = 0.0
    queue: int = 1 << 16
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("loss", "duplicate", "reorder", "corrupt"):
            if not 0 <= getattr(self, name) <= 1:
                raise InvalidArgumentError(f"{name} must be between 0 and 1, got {getattr(self, name)}")
        for name in ("latency", "jitter", "hold", "bandwidth", "queue"):
            if not 0 <= getattr(self, name) < math.inf:
                raise InvalidArgumentError(
                    f"{name} must be finite and not negative, got {getattr(self, name)}"
                )

    @classmethod
    def from_options(cls, options: Options) -> Self | None:
        """Read the impairment from the options of a URL.

        Args:
            options: The options of the URL.

        Returns:
            The impairment, or None if the URL has none of its options.

        Raises:
            LinkURLError: An option is malformed or out of range.
        """
        present = [field.name for field in fields(cls) if options.has(field.name)]
        modem = options.choice("impairment", ("none", *PROFILES))
        if not present and modem == "none":
            return None
        of_modem = PROFILES.get(modem, {})
        return cls(
            loss=options.fraction("loss", of_modem.get("loss", 0.0)),
            duplicate=options.fraction("duplicate", 0.0),
            reorder=options.fraction("reorder", 0.0),
            corrupt=options.fraction("corrupt", 0.0),
            latency=options.seconds("latency", of_modem.get("latency", 0.0)),
            jitter=options.seconds("jitter", of_modem.get("jitter", 0.0)),
            hold=options.seconds("hold", 0.1),
            bandwidth=float(options.size("bandwidth", 0)) or of_modem.get("bandwidth", 0.0),
            queue=options.size("queue", int(of_modem.get("queue", 1 << 16))),
            seed=options.integer("seed", 0, minimum=0),
        )


@dataclass(slots=True)
class FlowStats:
    """Counters of the chunks of one flow."""

    sent: int = 0
    delivered: int = 0
    lost: int = 0
    overflowed: int = 0
    duplicated: int = 0
    reordered: int = 0
    corrupted: int = 0


class Flow:
    """One direction of an impaired channel, driven by the caller's clock.

    Args:
        impairment: The parameters.
        name: Part of the random seed, so that flows of one impairment differ.
    """

    def __init__(self, impairment: Impairment, name: str = "") -> None:
        from random import Random  # a slow import, which links without impairments do not need

        self.stats = FlowStats()
        self._model = impairment
        self._random = Random(f"{impairment.seed}/{name}")
        self._idle_from = -math.inf  # the time at which the transmitter has sent its whole queue
        self._last_due = -math.inf
        self._order = count()
        self._in_transit: list[tuple[float, int, bytes]] = []

    def send(self, data: bytes, now: float) -> bool:
        """Send a chunk.

        Args:
            data: The bytes of the chunk.
            now: Current time in seconds.

        Returns:
            False if the transmitter's queue is full; a lost chunk returns True.
        """
        self.stats.sent += 1
        accepted = self._transmit(data, now)
        if self._draw(self._model.duplicate):
            self.stats.duplicated += 1
            self._transmit(data, now)
        return accepted

    def receive(self, now: float) -> list[bytes]:
        """Return the chunks that have arrived.

        Args:
            now: Current time in seconds.

        Returns:
            The chunks in order of arrival.
        """
        arrived = []
        while self._in_transit and self._in_transit[0][0] <= now:
            arrived.append(heappop(self._in_transit)[2])
        self.stats.delivered += len(arrived)
        return arrived

    def next_timeout(self) -> float | None:
        """Return the time at which the next chunk arrives, or None if none is in transit."""
        return self._in_transit[0][0] if self._in_transit else None

    def _transmit(self, data: bytes, now: float) -> bool:
        departure = self._depart(len(data), now)
        if departure is None:
            self.stats.overflowed += 1
            return False
        if self._draw(self._model.loss):
            self.stats.lost += 1
        else:
            heappush(self._in_transit, (self._arrival(departure), next(self._order), self._corrupt(data)))
        return True

    def _depart(self, size: int, now: float) -> float | None:
        """Return when the last byte leaves the transmitter, or None if its queue is full."""
        bandwidth = self._model.bandwidth
        if not bandwidth:
            return now
        start = max(now, self._idle_from)
        if start > now and (start - now) * bandwidth + size > self._model.queue:
            return None
        self._idle_from = start + size / bandwidth
        return self._idle_from

    def _arrival(self, departure: float) -> float:
        model = self._model
        delay = model.latency + (self._random.uniform(-model.jitter, model.jitter) if model.jitter else 0.0)
        due = max(departure + max(delay, 0.0), self._last_due)
        if self._draw(model.reorder):
            self.stats.reordered += 1
            return due + self._random.uniform(0.0, model.hold)
        self._last_due = due
        return due

    def _corrupt(self, data: bytes) -> bytes:
        """Flip bits; the distance to the next changed byte is drawn instead of one number per byte."""
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

    def _draw(self, chance: float) -> bool:
        return chance > 0 and self._random.random() < chance
