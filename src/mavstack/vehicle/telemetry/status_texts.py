"""The status texts of one system, joined from STATUSTEXT chunks and kept for a while."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.node.api_object import LoopBound
from mavstack.services import statustext
from mavstack.vehicle.telemetry.values import StatusText

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services import Address
    from mavstack.wire import Packet

#: The number of texts that are kept.
MAX_TEXTS = 200


class StatusTexts(LoopBound):
    """The last status texts of one system; every STATUSTEXT packet is passed to `receive`."""

    def __init__(self, local: Address, now: Callable[[], float]) -> None:
        self._receiver = statustext.StatustextReceiver(local)
        self._now = now
        self._texts: deque[StatusText] = deque(maxlen=MAX_TEXTS)

    def receive(self, packet: Packet) -> None:
        """Take in a STATUSTEXT packet."""
        now = self._now()
        self._receiver.handle_timeout(now)
        self._receiver.receive(packet, now)
        self._collect(now)

    def all(self) -> list[StatusText]:
        """Return all texts that are kept, oldest first."""
        due = self._receiver.next_timeout()
        if due is not None and self._now() >= due:
            self._receiver.handle_timeout(self._now())
            self._collect(due)
        return list(self._texts)

    def since(self, time: float) -> list[StatusText]:
        """Return the texts received at `time` (Unix seconds) or later."""
        return [text for text in self.all() if text.time >= time]

    def _collect(self, time: float) -> None:
        for event in self._receiver.events():
            if isinstance(event, statustext.StatusText):
                severity = event.severity
                member = common.MavSeverity(severity) if severity in _SEVERITIES else severity
                component, has_event = event.source.component, event.has_event
                self._texts.append(StatusText(time, member, event.text, component, has_event))


_SEVERITIES = frozenset(map(int, common.MavSeverity))
