"""What a vehicle told people, put together from STATUSTEXT and kept for a while."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import statustext
from mavstack.vehicle.telemetry.values import StatusText

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services import Address
    from mavstack.wire import Packet

MOST_TEXTS = 200


class StatusTexts:
    """The last texts of one system; each packet with one is given to `hear`."""

    def __init__(self, local: Address, now: Callable[[], float]) -> None:
        self._receiver = statustext.StatustextReceiver(local)
        self._now = now
        self._texts: deque[StatusText] = deque(maxlen=MOST_TEXTS)

    def hear(self, packet: Packet) -> None:
        """Take in a STATUSTEXT."""
        now = self._now()
        self._receiver.handle_timeout(now)
        self._receiver.receive(packet, now)
        self._take(now)

    def all(self) -> list[StatusText]:
        """All that are remembered, the oldest first."""
        due = self._receiver.next_timeout()
        if due is not None and self._now() >= due:
            self._receiver.handle_timeout(self._now())
            self._take(due)
        return list(self._texts)

    def since(self, time: float) -> list[StatusText]:
        """Those that were told at that time or later."""
        return [text for text in self.all() if text.time >= time]

    def _take(self, time: float) -> None:
        for event in self._receiver.events():
            if isinstance(event, statustext.StatusText):
                severity = event.severity
                known = common.MavSeverity(severity) if severity in _SEVERITIES else severity
                self._texts.append(StatusText(time, known, event.text, event.source.component))


_SEVERITIES = frozenset(map(int, common.MavSeverity))
