"""Logging of links, by the logger `mavstack.links`.

Links and channels that open and close are logged at level info; lost connections and dropped input at level
warning. Links are named by their redacted URL, so that no password or key is logged.
"""

from __future__ import annotations

import logging
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.links.channel import Channel
    from mavstack.links.url import LinkURL

DROP_LOG_INTERVAL = 10.0  # seconds between two records about dropped input

_logger = logging.getLogger("mavstack.links")
# A library writes nothing to stderr unless the program configures logging.
logging.getLogger("mavstack").addHandler(logging.NullHandler())


class LinkLog:
    """The log of one link."""

    def __init__(self, url: LinkURL) -> None:
        self._name = url.redacted
        self._down = False
        self._dropped = 0
        self._next_drop_record = 0.0

    def link_opened(self) -> None:
        """Log that the link is open."""
        _logger.info("%s: link opened", self._name)

    def link_closed(self) -> None:
        """Log that the link is closed."""
        _logger.info("%s: link closed", self._name)

    def channel_opened(self, channel: Channel) -> None:
        """Log a new channel."""
        self._down = False
        _logger.info("%s: channel %s opened", self._name, channel.name)

    def channel_closed(self, channel: Channel, reason: str) -> None:
        """Log a channel that closed."""
        _logger.info("%s: channel %s closed: %s", self._name, channel.name, reason)

    def link_down(self, reason: str, retry_in: float) -> None:
        """Log a lost connection or a failed attempt; only the first one in a row is a warning."""
        level = logging.INFO if self._down else logging.WARNING
        self._down = True
        _logger.log(level, "%s: link down: %s; next attempt in %g s", self._name, reason, retry_in)

    def dropped(self, count: int = 1) -> None:
        """Log dropped chunks: the first ones immediately, then a sum every `DROP_LOG_INTERVAL` seconds."""
        self._dropped += count
        now = monotonic()
        if now >= self._next_drop_record:
            self._next_drop_record = now + DROP_LOG_INTERVAL
            _logger.warning("%s: %d received chunks dropped", self._name, self._dropped)
            self._dropped = 0
