"""Writes to a WebSocket at once: an extension of ASGI that our server offers.

By ASGI an application awaits each send, in a task of its own, which takes a turn of the event loop and many
calls for each message. While a client reads as fast as the server writes, nothing waits before a message: it
can go to the socket at once, and several messages by one system call.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final, TypeAlias, cast

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

#: Writes complete messages and returns True; returns False, and writes nothing, if the connection is not open
#: or bytes of it still wait.
WriteNow: TypeAlias = Callable[[Sequence[str | bytes]], bool]

#: The name of the extension, and its key.
EXTENSION: Final = "mavstack.immediate_writes"
WRITE: Final = "write"


def immediate_writer(websocket: WebSocket) -> WriteNow | None:
    """Return the function that writes to a WebSocket at once; None: its server offers none."""
    extension = websocket.scope.get("extensions", {}).get(EXTENSION, {})
    return cast("WriteNow | None", extension.get(WRITE))
