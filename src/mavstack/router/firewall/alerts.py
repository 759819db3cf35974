"""Alerts of the firewall, and how often the same one is raised."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.services import Address

#: Seconds in which further alerts of one detector about one source are counted, not raised.
REPEAT_INTERVAL: Final = 10.0
#: Maximum number of sources whose last alert is kept.
MAX_REMEMBERED: Final = 4096
_STATUSTEXT_BYTES: Final = 50


@dataclass(frozen=True, slots=True)
class Alert:
    """Something that the firewall noticed.

    Attributes:
        detector: Name of the detector, or `rule` and the name of the rule.
        origin: Name of the endpoint or of its group.
        source: The system and component that the packet names as its sender; None: the whole endpoint.
        text: The reason, in a few words.
        refuse: The packet is dropped, unless in a dry run.
        count: Alerts of this kind since the last one that was raised, this one included.
    """

    detector: str
    origin: str
    source: Address | None
    text: str
    refuse: bool = True
    count: int = 1

    def __str__(self) -> str:
        source = "" if self.source is None else f" {self.source}"
        repeated = f" ({self.count} times)" if self.count > 1 else ""
        return f"{self.detector}: {self.origin}{source}: {self.text}{repeated}"

    def statustext(self) -> common.Statustext:
        """Return the alert as a message for ground stations.

        Returns:
            A STATUSTEXT of severity ALERT, cut to one message.
        """
        text = f"Firewall {self}".encode()[:_STATUSTEXT_BYTES].decode(errors="ignore")
        return common.Statustext(severity=common.MavSeverity.ALERT, text=text)


class AlertLimiter:
    """Lets the first alert of a kind pass, and then one in each `REPEAT_INTERVAL` with the count."""

    def __init__(self) -> None:
        self._last: dict[tuple[str, str, Address | None], tuple[float, int]] = {}

    def limited(self, alert: Alert, now: float) -> Alert | None:
        """Return the alert with its count, or None if it is counted for the next one.

        Args:
            alert: The alert.
            now: Time in seconds.

        Returns:
            The alert to raise, or None.
        """
        kind = (alert.detector, alert.origin, alert.source)
        raised, count = self._last.get(kind, (float("-inf"), 0))
        if now - raised < REPEAT_INTERVAL:
            self._last[kind] = (raised, count + 1)
            return None
        if len(self._last) >= MAX_REMEMBERED:
            self._last.pop(next(iter(self._last)))
        self._last.pop(kind, None)
        self._last[kind] = (now, 0)
        return replace(alert, count=count + 1)
