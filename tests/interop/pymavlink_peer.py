"""pymavlink as a peer in a test: it blocks, so what it does runs in a thread beside the event loop."""

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

#: Longer than anything takes on a busy machine.
PATIENCE = 40.0

Result = TypeVar("Result")


def connection_to(port: int, key: SigningKey | None = None):
    """A ground station of `mavutil` that has said that it is there, and signs if it has a key."""
    if key is not None and not mavutil.mavlink20():
        # At its first packet of version 2 it begins anew, without its key: so begin with version 2.
        os.environ["MAVLINK20"] = "1"
        mavutil.set_dialect(mavutil.current_dialect)
    connection = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=250)
    if key is not None:
        connection.setup_signing(key.secret_bytes())
    say_hello(connection)
    return connection


def say_hello(connection) -> None:
    gcs = mavutil.mavlink.MAV_TYPE_GCS, mavutil.mavlink.MAV_AUTOPILOT_INVALID
    connection.mav.heartbeat_send(*gcs, 0, 0, 0)


def connected(port: int, key: SigningKey | None = None):
    """The same, when it has heard the vehicle's heartbeat."""
    connection = connection_to(port, key)
    assert connection.wait_heartbeat(timeout=PATIENCE), "no heartbeat"
    return connection


async def in_thread(port: int, work: Callable[[Any], Result], key: SigningKey | None = None) -> Result:
    """What `work` gives, done with a connection of mavutil while our side runs."""

    def carry_out() -> Result:
        with closing(connected(port, key)) as connection:
            return work(connection)

    async with asyncio.timeout(2 * PATIENCE):
        return await asyncio.to_thread(carry_out)


def receive(connection, kind: str, wanted: Callable[[Any], bool] = lambda message: True):
    """The next message of a kind that `wanted` is true for; the others are dropped."""
    deadline = monotonic() + PATIENCE
    while (left := deadline - monotonic()) > 0:
        message = connection.recv_match(type=kind, blocking=True, timeout=left)
        if message is not None and wanted(message):
            return message
    raise AssertionError(f"no {kind} as wanted")
