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

_PATH: Final = re.compile(r"/api/vehicles/([1-9][0-9]{0,2})/messages/([A-Za-z0-9_]{1,60})")
#: Maximum number of message names whose ids are cached.
_MAX_NAMES: Final = 1024


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
        self._ids: dict[str, int] = {}

    def answer(self, request: EarlyRequest) -> bytes | None:
        """Return the answer; None: the application answers."""
        found = _PATH.fullmatch(request.path)
        if found is None:
            return None
        try:
            client = self._access.check_headers(request.headers, cookie_of(request.headers.get("cookie", "")))
            if client.role is Role.OBSERVE:
                return None
            mark_client(client.proof, client.holder)
            return self._latest(int(found[1]), found[2])
        except (RefusedError, MavstackError):
            return None

    def _latest(self, system: int, name: str) -> bytes | None:
        latest = self._station.packets.latest.find(system, self._id_of(name))
        if latest is None or system not in self._station.connection.vehicles:
            return None
        return self._writer.write(latest_json(latest, self._station.connection.now()).encode())

    def _id_of(self, name: str) -> int:
        found = self._ids.get(name)
        if found is None:
            found = int(message_class(self._station.connection.dialect, name).__mavlink_row__[0])
            if len(self._ids) < _MAX_NAMES:
                self._ids[name] = found
        return found
