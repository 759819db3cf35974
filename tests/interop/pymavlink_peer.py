"""pymavlink as a test peer; it blocks, so it runs in a thread beside the event loop."""

from __future__ import annotations

import asyncio
import os
from contextlib import closing
from time import monotonic
from typing import TYPE_CHECKING, Any, TypeVar

from pymavlink import mavutil

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.security import SigningKey

#: Seconds for one answer, enough for a busy machine.
TIMEOUT = 40.0

Result = TypeVar("Result")


def connection_to(port: int, key: SigningKey | None = None):
    """Return a `mavutil` ground station that has sent a heartbeat, and signs if there is a key."""
    if key is not None and not mavutil.mavlink20():
        # At its first version 2 packet mavutil resets the connection and loses the key: start with version 2.
        os.environ["MAVLINK20"] = "1"
        mavutil.set_dialect(mavutil.current_dialect)
    connection = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=250)
    if key is not None:
        connection.setup_signing(key.secret_bytes())
    send_heartbeat(connection)
    return connection


def send_heartbeat(connection) -> None:
    gcs = mavutil.mavlink.MAV_TYPE_GCS, mavutil.mavlink.MAV_AUTOPILOT_INVALID
    connection.mav.heartbeat_send(*gcs, 0, 0, 0)


def connected(port: int, key: SigningKey | None = None):
    """Return a ground station that has received the vehicle's heartbeat."""
    connection = connection_to(port, key)
    assert connection.wait_heartbeat(timeout=TIMEOUT), "no heartbeat"
    return connection


async def in_thread(port: int, work: Callable[[Any], Result], key: SigningKey | None = None) -> Result:
    """Run `work` with a mavutil connection in a thread; return its result."""

    def run() -> Result:
        with closing(connected(port, key)) as connection:
            return work(connection)

    async with asyncio.timeout(2 * TIMEOUT):
        return await asyncio.to_thread(run)


def receive(connection, kind: str, predicate: Callable[[Any], bool] = lambda message: True):
    """Return the next message of this type for which `predicate` is true; drop the others."""
    deadline = monotonic() + TIMEOUT
    while (left := deadline - monotonic()) > 0:
        message = connection.recv_match(type=kind, blocking=True, timeout=left)
        if message is not None and predicate(message):
            return message
    raise AssertionError(f"no matching {kind}")
