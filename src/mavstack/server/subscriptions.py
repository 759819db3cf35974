"""The messages that a client wants: by id, from which sender, and at which highest rate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.wire import Packet

MAX_RATE: Final = 1000.0
#: Maximum number of messages with a stored next send time, for clients that limit the rate.
MAX_TIMES: Final = 8192
#: The id that means all message ids.
ALL: Final = -1


class _Wanted(NamedTuple):
    """A subscription: the shortest interval in seconds, and the sender."""

    interval: float
    system: int | None
    component: int | None


class Subscriptions:
    """The subscriptions of one client."""

    def __init__(self) -> None:
        self._wanted: dict[int, _Wanted] = {}
        self._next_times: dict[tuple[int, int, int], float] = {}

    def add(
        self, ids: Iterable[int], *, rate: float | None, system: int | None, component: int | None
    ) -> None:
        """Add or change subscriptions.

        Args:
            ids: The ids of the messages; `ALL` stands for those without a subscription of their own.
            rate: The highest rate of each message from each component, in hertz; None: all.
            system: The system id of the sender; None: any.
            component: The component id of the sender; None: any.
        """
        interval = 0.0 if rate is None else 1.0 / rate
        self._wanted |= dict.fromkeys(ids, _Wanted(interval, system, component))

    def remove(self, ids: Iterable[int]) -> None:
        """Remove subscriptions. Idempotent."""
        for number in ids:
            self._wanted.pop(number, None)

    def wants(self, packet: Packet, time: float) -> bool:
        """Return whether a packet that was received at a Unix time is for the client; its rate counts it."""
        wanted = self._wanted.get(packet.message_id) or self._wanted.get(ALL)
        if wanted is None:
            return False
        if wanted.system not in (None, packet.system) or wanted.component not in (None, packet.component):
            return False
        key = (packet.system, packet.component, packet.message_id)
        return not wanted.interval or self._is_due(key, time, wanted.interval)

    def _is_due(self, key: tuple[int, int, int], time: float, interval: float) -> bool:
        due = self._next_times.get(key, time)
        if time < due - interval * 0.05:  # a tolerance of 5 %, since the interval of the sender varies
            return False
        if len(self._next_times) >= MAX_TIMES:
            self._next_times.clear()
        self._next_times[key] = max(due + interval, time)
        return True
