"""pymavlink as a peer in a test: it blocks, so what it does runs in a thread beside the event loop."""

from __future__ import annotations

import asyncio
from contextlib import closing
from time import monotonic
from typing import TYPE_CHECKING, Any, TypeVar

from pymavlink import mavutil

if TYPE_CHECKING:
    from collections.abc import Callable

#: Longer than anything takes on a busy machine.
PATIENCE = 40.0

Result = TypeVar("Result")


def connected(port: int):
    """A ground station of `mavutil` that has heard the vehicle's heartbeat."""
    connection = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=250)
    gcs = mavutil.mavlink.MAV_TYPE_GCS, mavutil.mavlink.MAV_AUTOPILOT_INVALID
    connection.mav.heartbeat_send(*gcs, 0, 0, 0)
    assert connection.wait_heartbeat(timeout=PATIENCE), "no heartbeat"
    return connection


async def in_thread(port: int, work: Callable[[Any], Result]) -> Result:
    """What `work` gives, done with a connection of mavutil while our side runs."""

    def carry_out() -> Result:
        with closing(connected(port)) as connection:
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
