"""Admission to tables with a bounded number of places: peers of links, connections, sessions, streams.

Any program can open many ports, connections and files; these must not lock out a vehicle or a pilot that
comes later. A full table therefore takes a place away for a newcomer, in this order:

1. a place whose holder has proved nothing yet (`Proof.SILENT`), or that was not used for a while;
2. if the newcomer has proved its identity, the place of a holder that has not;
3. if one address has more than half of the places, one of them, for a newcomer from another address.

Among these the lowest proof comes first, then the address with the most places, then the place that was
used longest ago. No place of an authenticated holder is taken away while it is in use: what is
not authenticated costs an authenticated client nothing. Newcomers that have proved nothing replace places at
a limited rate, so that each stays for `min_stay` seconds on average, however many come; those that have
proved their identity are not limited.

The module has no clock and no sockets: the tables pass their places and the time.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

#: Seconds for which the place of an unauthenticated and of an authenticated holder is kept without use.
USE_TIMEOUT = 3.0
AUTHENTICATED_TIMEOUT = 30.0
#: Minimum mean time in seconds for which a newcomer without a proof keeps its place.
MIN_STAY = 4.0

T_co = TypeVar("T_co", covariant=True)


class Proof(IntEnum):
    """The proof of a place's holder: none, that it speaks the protocol, or its identity."""

    SILENT = 0
    SPEAKING = 1
    AUTHENTICATED = 2


@dataclass(frozen=True, slots=True)
class Place(Generic[T_co]):
    """One place of a table.

    Attributes:
        owner: The connection, session or peer that has the place.
        holder: The address, or another name, whose places are counted together.
        proof: What the owner has proved.
        used_at: The time of its last use, such as that of its last valid packet, in seconds.
    """

    owner: T_co
    holder: str
    proof: Proof
    used_at: float


class Decision(NamedTuple, Generic[T_co]):
    """The decision on a newcomer: whether it is admitted, and the owner that has to leave for it."""

    admitted: bool
    leaving: T_co | None = None


class Admission:
    """Decides on the newcomers of one table.

    Args:
        max_places: The places of the table.
        min_stay: Mean time in seconds for which a newcomer that has proved nothing keeps its place at least;
            0: newcomers are not limited, for tables whose newcomers speak at once.
        timeout: Seconds after its last use for which the place of an unauthenticated holder is kept.
    """

    def __init__(self, max_places: int, *, min_stay: float = MIN_STAY, timeout: float = USE_TIMEOUT) -> None:
        self.max_places = max_places
        self._min_stay = min_stay
        self._timeout = timeout
        self._burst = max(1.0, max_places / 4)
        self._allowance = self._burst
        self._updated = 0.0

    def admit(
        self, holder: str, places: Sequence[Place[T_co]], now: float, proof: Proof = Proof.SILENT
    ) -> Decision[T_co]:
        """Decide on a newcomer.

        Args:
            holder: The address of the newcomer, or another name, as in `Place.holder`.
            places: The places in use.
            now: The time in seconds.
            proof: What the newcomer has proved.

        Returns:
            The decision; the caller removes the owner that leaves.
        """
        if len(places) < self.max_places:
            return Decision(admitted=True)
        if proof < Proof.AUTHENTICATED and not self._has_allowance(now):
            return Decision(admitted=False)
        chosen = self._choose(holder, places, now, proof)
        if chosen is None:
            return Decision(admitted=False)
        if proof < Proof.AUTHENTICATED:
            self._allowance -= 1
        return Decision(admitted=True, leaving=chosen.owner)

    def _has_allowance(self, now: float) -> bool:
        if not self._min_stay:
            return True
        elapsed, self._updated = max(0.0, now - self._updated), now
        added = elapsed * self.max_places / self._min_stay
        self._allowance = min(self._burst, self._allowance + added)
        return self._allowance >= 1

    def _choose(
        self, holder: str, places: Sequence[Place[T_co]], now: float, proof: Proof
    ) -> Place[T_co] | None:
        shares = Counter(place.holder for place in places)
        candidates = [place for place in places if self._is_free(place, now, proof)]
        if not candidates:
            candidates = list(self._excess(holder, places, shares))
        return min(
            candidates, key=lambda each: (each.proof, -shares[each.holder], each.used_at), default=None
        )

    def _is_free(self, place: Place[T_co], now: float, proof: Proof) -> bool:
        if place.proof is Proof.SILENT:
            return True
        if place.proof is Proof.AUTHENTICATED:
            return now - place.used_at > AUTHENTICATED_TIMEOUT
        return proof is Proof.AUTHENTICATED or now - place.used_at > self._timeout

    def _excess(
        self, holder: str, places: Sequence[Place[T_co]], shares: Counter[str]
    ) -> Iterable[Place[T_co]]:
        """Yield the unauthenticated places of the address that has more than half of all."""
        largest, count = shares.most_common(1)[0]
        if largest == holder or count <= self.max_places // 2:
            return
        for place in places:
            if place.holder == largest and place.proof < Proof.AUTHENTICATED:
                yield place
