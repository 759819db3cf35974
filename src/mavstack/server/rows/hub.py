"""The hub that hands rows to the clients of WebSockets, and keeps the latest ones."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from mavstack.server.rows.template import Row


@dataclass(slots=True)
class LatestRow:
    """The latest row of one message of one source, and how many there were."""

    value: dict[str, Any]
    count: int = 0


class RowListener(Protocol):
    """A client that is handed rows; it must not block."""

    def put_row(self, value: dict[str, Any]) -> None:
        """Queue a row as JSON, or drop it."""


class RowHub:
    """The rows of all sources. A source has at most as many messages as templates, so `latest` is bounded."""

    def __init__(self) -> None:
        self.clients: set[RowListener] = set()
        self.latest: dict[tuple[str, str], LatestRow] = {}

    def publish(self, source: str, row: Row, time: float) -> None:
        """Hand on a row with its Unix time of receipt in seconds."""
        value: dict[str, Any] = {"source": source, "message": row.message, "time": time, "fields": row.fields}
        if row.data is not None:
            value["data"] = b64encode(row.data).decode("ascii")
        latest = self.latest.setdefault((source, row.message), LatestRow(value))
        latest.value = value
        latest.count += 1
        for client in tuple(self.clients):
            client.put_row(value)

    def forget(self, source: str) -> None:
        """Drop the latest rows of a source that was removed."""
        for key in [key for key in self.latest if key[0] == source]:
            del self.latest[key]
