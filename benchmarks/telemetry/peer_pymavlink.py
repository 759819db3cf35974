"""The loop over pymavlink's `recv_match` as in its examples, and message hooks."""

from __future__ import annotations

import os
from operator import attrgetter
from typing import TYPE_CHECKING, Any

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil

from .child import FIELDS, MessageRecorder, serve

if TYPE_CHECKING:
    from collections.abc import Callable

READERS: dict[str, Callable[[Any], object]] = {name: attrgetter(*fields) for name, fields in FIELDS.items()}


def _connected(recorder: MessageRecorder) -> Any:  # noqa: ANN401 (the package has no types)
    connection = mavutil.mavlink_connection(f"udpin:127.0.0.1:{recorder.port}")
    connection.wait_heartbeat()
    return connection


def _receive(recorder: MessageRecorder, message: Any) -> None:  # noqa: ANN401
    read = READERS.get(message.get_type())
    if read is not None:
        read(message)
    recorder.record(message.get_msgId())


def _loop(recorder: MessageRecorder) -> None:
    connection = _connected(recorder)
    while True:
        _receive(recorder, connection.recv_match(blocking=True))


def _hooks(recorder: MessageRecorder) -> None:
    connection = _connected(recorder)
    connection.message_hooks.append(lambda _connection, message: _receive(recorder, message))
    while True:
        if connection.recv_msg() is None:
            connection.select(0.5)


if __name__ == "__main__":
    serve({"loop": _loop, "hooks": _hooks})
