"""pymavlink's side: the calls its own documentation and tools make, written as fast as they go.

Every function does its work once and gives the seconds it took per message. The dialect module is the
one that PyPI ships. Where pymavlink has a cheaper call for the same work it gets it: `parse_char` with a
whole packet (one call less than `parse_buffer`), positional fields, `pack` instead of `send` (no file, no
callback).
"""

from __future__ import annotations

import importlib
import os
from collections import defaultdict
from operator import attrgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from .mix import FLOWS
from .workload import SIGNING_KEY, layout, metadata

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


def _readers() -> dict[type, attrgetter[Any]]:
    return {layout(flow.name): attrgetter(*flow.three) for flow in FLOWS}


def _checked(seen: int, count: int, start: float, end: float) -> float:
    if seen != count:
        raise RuntimeError(f"pymavlink saw {seen} of {count} messages")
    return (end - start) / count


def live(chunks: list[bytes], count: int) -> float:
    """Chunks of a stream to message objects, three fields read from each."""
    mav, read, seen = metadata().MAVLink(None), _readers(), 0
    start = perf_counter()
    for chunk in chunks:
        messages = mav.parse_buffer(chunk) or ()
        for message in messages:
            read[type(message)](message)
        seen += len(messages)
    return _checked(seen, count, start, perf_counter())


def single(packets: list[bytes]) -> float:
    """The same, one call a packet."""
    mav, read, seen = metadata().MAVLink(None), _readers(), 0
    start = perf_counter()
    for packet in packets:
        message = mav.parse_char(packet)
        read[type(message)](message)
        seen += 1
    return _checked(seen, len(packets), start, perf_counter())


def encode(values: list[tuple[Any, ...]]) -> float:
    """ATTITUDE's seven fields to a packet's bytes."""
    mav = metadata().MAVLink(None, srcSystem=1, srcComponent=1)
    start = perf_counter()
    for boot, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed in values:
        mav.attitude_encode(boot, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed).pack(mav)
    return (perf_counter() - start) / len(values)


def verify(chunks: list[bytes], count: int) -> float:
    """Signed packets, in chunks, to verified messages (it has no way not to make them)."""
    mav, seen = metadata().MAVLink(None), 0
    mav.signing.secret_key = SIGNING_KEY
    start = perf_counter()
    for chunk in chunks:
        seen += len(mav.parse_buffer(chunk) or ())
    end = perf_counter()
    return _checked(min(seen, mav.signing.goodsig_count), count, start, end)


def columns(path: Path) -> dict[str, dict[str, NDArray[Any]]]:
    """A telemetry log to columns: every message, every field, and the time."""
    os.environ["MAVLINK20"] = "1"
    mavutil = importlib.import_module("pymavlink.mavutil")
    log = mavutil.mavlink_connection(str(path), dialect="ardupilotmega")
    lists: dict[str, dict[str, list[Any]]] = defaultdict(lambda: defaultdict(list))
    while (message := log.recv_msg()) is not None:
        table = lists[message.get_type()]
        table["_timestamp"].append(message._timestamp)  # noqa: SLF001 (pymavlink's only name for it)
        for name in message.get_fieldnames():
            table[name].append(getattr(message, name))
    log.close()
    return {
        message: {name: np.array(column) for name, column in table.items()}
        for message, table in lists.items()
    }


def tlog(path: Path, count: int) -> float:
    """The seconds that `columns` takes per message."""
    start = perf_counter()
    tables = columns(path)
    end = perf_counter()
    return _checked(sum(len(table["_timestamp"]) for table in tables.values()), count, start, end)
