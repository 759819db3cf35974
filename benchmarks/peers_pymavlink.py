"""The benchmarks of pymavlink: the calls of its documentation and tools, in their fastest form.

Every function does its work once and returns the seconds per message. The dialect module is the one on PyPI.
Where pymavlink has a cheaper call for the same work, that is used: `parse_char` with a whole packet (one call
less than `parse_buffer`), positional fields, `pack` instead of `send` (no file, no callback).
"""

from __future__ import annotations

import importlib
import os
from collections import defaultdict
from operator import attrgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from .mix import PROFILES
from .workload import SIGNING_KEY, dialect_module, layout

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


def _readers() -> dict[type, attrgetter[Any]]:
    return {layout(profile.name): attrgetter(*profile.read_fields) for profile in PROFILES}


def _seconds_per_message(received: int, count: int, start: float, end: float) -> float:
    if received != count:
        raise RuntimeError(f"pymavlink received {received} of {count} messages")
    return (end - start) / count


def live(chunks: list[bytes], count: int) -> float:
    """Parse chunks of a stream to message objects, and read three fields of each."""
    mav, read, received = dialect_module().MAVLink(None), _readers(), 0
    start = perf_counter()
    for chunk in chunks:
        messages = mav.parse_buffer(chunk) or ()
        for message in messages:
            read[type(message)](message)
        received += len(messages)
    return _seconds_per_message(received, count, start, perf_counter())


def single(packets: list[bytes]) -> float:
    """Parse one packet per call to message objects, and read three fields of each."""
    mav, read, received = dialect_module().MAVLink(None), _readers(), 0
    start = perf_counter()
    for packet in packets:
        message = mav.parse_char(packet)
        read[type(message)](message)
        received += 1
    return _seconds_per_message(received, len(packets), start, perf_counter())


def encode(values: list[tuple[Any, ...]]) -> float:
    """Encode the seven fields of ATTITUDE to packets."""
    mav = dialect_module().MAVLink(None, srcSystem=1, srcComponent=1)
    start = perf_counter()
    for boot, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed in values:
        mav.attitude_encode(boot, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed).pack(mav)
    return (perf_counter() - start) / len(values)


def verify(chunks: list[bytes], count: int) -> float:
    """Verify signed packets in chunks; pymavlink always creates the messages."""
    mav, received = dialect_module().MAVLink(None), 0
    mav.signing.secret_key = SIGNING_KEY
    start = perf_counter()
    for chunk in chunks:
        received += len(mav.parse_buffer(chunk) or ())
    end = perf_counter()
    return _seconds_per_message(min(received, mav.signing.goodsig_count), count, start, end)


def columns(path: Path) -> dict[str, dict[str, NDArray[Any]]]:
    """Decode a tlog to columns: all messages, all fields and the times."""
    os.environ["MAVLINK20"] = "1"
    mavutil = importlib.import_module("pymavlink.mavutil")
    return gather(mavutil.mavlink_connection(str(path), dialect="ardupilotmega"), times=True)


def gather(log: Any, *, times: bool) -> dict[str, dict[str, NDArray[Any]]]:  # noqa: ANN401 (pymavlink has no types)
    """Read a log of pymavlink to columns: all messages and all fields, with or without the times."""
    lists: dict[str, dict[str, list[Any]]] = defaultdict(lambda: defaultdict(list))
    while (message := log.recv_msg()) is not None:
        table = lists[message.get_type()]
        if times:
            table["_timestamp"].append(message._timestamp)  # noqa: SLF001 (pymavlink's only name for it)
        for name in message.get_fieldnames():
            table[name].append(getattr(message, name))
    log.close()
    return {
        message: {name: np.array(column) for name, column in table.items()}
        for message, table in lists.items()
    }


def tlog(path: Path, count: int) -> float:
    """Return the seconds per message of `columns`."""
    start = perf_counter()
    tables = columns(path)
    end = perf_counter()
    return _seconds_per_message(sum(len(table["_timestamp"]) for table in tables.values()), count, start, end)
