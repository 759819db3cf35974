"""The refusal of messages of clients that observe, which would reach the vehicles too often."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.server.station import Station


def check_request(role: Role, message: Message, station: Station) -> None:
    """Refuse a request of a client that observes if it, or an equal one, reached the vehicles a moment ago.

    Args:
        role: The role of the client.
        message: The message that it sends.
        station: The station, which knows the requests of all clients that observe.

    Raises:
        RefusedError: It is a request too many.
    """
    if role is Role.OBSERVE and not station.observers.passes(message, station.connection.now()):
        raise RefusedError(
            429, "observing clients have just sent this request, or too many requests: try again later"
        )
