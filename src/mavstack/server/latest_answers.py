"""The latest message of a name, answered from the head of its request (see `mavstack.http.early_answers`).

The answer is the one of the route `/api/vehicles/{system}/messages/{name}` without a query, for clients that
may act: observers wait for their turn in their lane.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from mavstack.errors import MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.http.connections import mark_client
from mavstack.http.early_answers import AnswerWriter
from mavstack.security.roles import Role
from mavstack.server.access import cookie_of
from mavstack.server.message_json import latest_json, message_class

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.http.early_answers import EarlyRequest
    from mavstack.server.access import Access
    from mavstack.server.station import Station

_BEGIN: Final = "/api/vehicles/"
_PATH: Final = re.compile(_BEGIN + r"([1-9][0-9]{0,2})/messages/([A-Za-z0-9_]{1,60})")
#: Maximum number of paths that are remembered.
_MAX_PLACES: Final = 1024


class LatestAnswers:
    """Answers requests of latest messages.

    Args:
        station: The station.
        access: The decision on its clients.
        fields: The fields of all answers of the station.
    """

    def __init__(self, station: Station, access: Access, fields: Iterable[tuple[bytes, bytes]]) -> None:
        self._station = station
        self._access = access
        own = ((b"cache-control", b"no-store"), (b"content-type", b"application/json"))
        self._writer = AnswerWriter((*own, *fields))
        self._places: dict[str, tuple[int, int]] = {}

    def answer(self, request: EarlyRequest) -> bytes | None:
        """Return the answer; None: the application answers."""
        if not request.path.startswith(_BEGIN):
            return None
        try:
            client = self._access.check_headers(request.headers, cookie_of(request.headers.get("cookie", "")))
            if client.role is Role.OBSERVE:
                return None
            place = self._places.get(request.path) or self._find_place(request.path)
            if place is None:
                return None
            mark_client(client.proof, client.holder)
            return self._latest(*place)
        except (RefusedError, MavstackError):
            return None

    def _latest(self, system: int, message_id: int) -> bytes | None:
        latest = self._station.packets.latest.find(system, message_id)
        if latest is None or system not in self._station.connection.vehicles:
            return None
        return self._writer.write(latest_json(latest, self._station.connection.now()).encode())

    def _find_place(self, path: str) -> tuple[int, int] | None:
        """Return the system and the message id of a path, and remember them."""
        found = _PATH.fullmatch(path)
        if found is None:
            return None
        kind = message_class(self._station.connection.dialect, found[2])
        place = int(found[1]), int(kind.__mavlink_row__[0])
        if len(self._places) < _MAX_PLACES:
            self._places[path] = place
        return place
