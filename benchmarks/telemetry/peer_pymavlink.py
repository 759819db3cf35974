"""pymavlink: the loop over `recv_match` that its examples have, and hooks that it calls with each message."""

from __future__ import annotations

import os
from operator import attrgetter
from typing import TYPE_CHECKING, Any

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil

from .child import FIELDS, Ear, serve

if TYPE_CHECKING:
    from collections.abc import Callable

READERS: dict[str, Callable[[Any], object]] = {name: attrgetter(*fields) for name, fields in FIELDS.items()}


def _connected(ear: Ear) -> Any:  # noqa: ANN401 (the package has no types)
    connection = mavutil.mavlink_connection(f"udpin:127.0.0.1:{ear.port}")
    connection.wait_heartbeat()
    return connection


def _take(ear: Ear, message: Any) -> None:  # noqa: ANN401
    read = READERS.get(message.get_type())
    if read is not None:
        read(message)
    ear.hear(message.get_msgId())


def _loop(ear: Ear) -> None:
    connection = _connected(ear)
    while True:
        _take(ear, connection.recv_match(blocking=True))


def _hooks(ear: Ear) -> None:
    connection = _connected(ear)
    connection.message_hooks.append(lambda _connection, message: _take(ear, message))
    while True:
        if connection.recv_msg() is None:
            connection.select(0.5)


if __name__ == "__main__":
    serve({"loop": _loop, "hooks": _hooks})
