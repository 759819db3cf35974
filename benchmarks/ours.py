"""Our side: the public interface of `mavstack`, and the same loops that the peers run."""

from __future__ import annotations

from operator import attrgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any

import mavstack
from mavstack.dialects import ardupilotmega

from .mix import FLOWS
from .workload import SIGNING_KEY, START_UNIX_US

if TYPE_CHECKING:
    from pathlib import Path


def _readers() -> dict[type, attrgetter[Any]]:
    dialect = mavstack.Dialect.load("ardupilotmega")
    return {dialect[flow.name]: attrgetter(*flow.three) for flow in FLOWS}


def _checked(seen: int, count: int, start: float, end: float) -> float:
    if seen != count:
        raise RuntimeError(f"mavstack saw {seen} of {count} messages")
    return (end - start) / count


def live(chunks: list[bytes], count: int) -> float:
    """Chunks of a stream to typed messages, three fields read from each."""
    parser, read, seen = mavstack.Parser(ardupilotmega), _readers(), 0
    start = perf_counter()
    for chunk in chunks:
        packets = parser.feed(chunk)
        for packet in packets:
            message = packet.message
            read[type(message)](message)
        seen += len(packets)
    return _checked(seen, count, start, perf_counter())


def single(packets: list[bytes]) -> float:
    """The same, one call a packet."""
    parser, read, seen = mavstack.Parser(ardupilotmega), _readers(), 0
    start = perf_counter()
    for data in packets:
        for packet in parser.feed(data):
            message = packet.message
            read[type(message)](message)
            seen += 1
    return _checked(seen, len(packets), start, perf_counter())


def encode(values: list[tuple[Any, ...]]) -> float:
    """ATTITUDE's seven fields to a packet's bytes."""
    encoder = mavstack.Encoder(system=1, component=1)
    attitude = ardupilotmega.Attitude
    start = perf_counter()
    for boot, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed in values:
        encoder.encode(
            attitude(
                time_boot_ms=boot,
                roll=roll,
                pitch=pitch,
                yaw=yaw,
                rollspeed=rollspeed,
                pitchspeed=pitchspeed,
                yawspeed=yawspeed,
            )
        )
    return (perf_counter() - start) / len(values)


def verify(chunks: list[bytes], count: int) -> float:
    """Signed packets, in chunks, to verified packets; no message objects."""
    signing = mavstack.Signing(SIGNING_KEY)
    parser, seen, now = mavstack.Parser(ardupilotmega, signing=signing), 0, START_UNIX_US / 1e6
    start = perf_counter()
    for chunk in chunks:
        seen += len(parser.feed(chunk, now=now))
    return _checked(seen, count, start, perf_counter())


def columns(path: Path, threads: int = 0) -> dict[str, Any]:
    """A telemetry log to columns: every message, every field, and the time; by default on all cores."""
    log = mavstack.open_log(path, threads=threads)
    log.load()
    tables = {name: log[name] for name in log}
    for table in tables.values():
        for name in table.dtype.names or ():
            table[name]
    return tables


def tlog(path: Path, count: int, threads: int = 0) -> float:
    """The seconds that `columns` takes per message."""
    start = perf_counter()
    tables = columns(path, threads)
    end = perf_counter()
    return _checked(sum(len(table) for table in tables.values()), count, start, end)


def stream(path: Path, size: int) -> int:
    """A log of any size through the parser, a chunk at a time: the messages seen."""
    parser, seen = mavstack.Parser(ardupilotmega, timestamped=True), 0
    with path.open("rb") as file:
        while chunk := file.read(size):
            seen += sum(packet.message is not None for packet in parser.feed(chunk))
    return seen
