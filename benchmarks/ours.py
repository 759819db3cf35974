"""The benchmarks of Mavstack: its public API, in the same loops as those of the peers."""

from __future__ import annotations

from operator import attrgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any

import mavstack
from mavstack.dialects import ardupilotmega

from .mix import PROFILES
from .workload import SIGNING_KEY, START_UNIX_US

if TYPE_CHECKING:
    from pathlib import Path


def _readers() -> dict[type, attrgetter[Any]]:
    dialect = mavstack.Dialect.load("ardupilotmega")
    return {dialect[profile.name]: attrgetter(*profile.read_fields) for profile in PROFILES}


def _seconds_per_message(received: int, count: int, start: float, end: float) -> float:
    if received != count:
        raise RuntimeError(f"mavstack received {received} of {count} messages")
    return (end - start) / count


def live(chunks: list[bytes], count: int) -> float:
    """Parse chunks of a stream to typed messages, and read three fields of each."""
    parser, read, received = mavstack.Parser(ardupilotmega), _readers(), 0
    start = perf_counter()
    for chunk in chunks:
        packets = parser.feed(chunk)
        for packet in packets:
            message = packet.message
            read[type(message)](message)
        received += len(packets)
    return _seconds_per_message(received, count, start, perf_counter())


def single(packets: list[bytes]) -> float:
    """Parse one packet per call to typed messages, and read three fields of each."""
    parser, read, received = mavstack.Parser(ardupilotmega), _readers(), 0
    start = perf_counter()
    for data in packets:
        for packet in parser.feed(data):
            message = packet.message
            read[type(message)](message)
            received += 1
    return _seconds_per_message(received, len(packets), start, perf_counter())


def encode(values: list[tuple[Any, ...]]) -> float:
    """Encode the seven fields of ATTITUDE to packets."""
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
    """Verify signed packets in chunks, without creating messages."""
    signing = mavstack.Signing(SIGNING_KEY)
    parser, received, now = mavstack.Parser(ardupilotmega, signing=signing), 0, START_UNIX_US / 1e6
    start = perf_counter()
    for chunk in chunks:
        received += len(parser.feed(chunk, now=now))
    return _seconds_per_message(received, count, start, perf_counter())


def columns(path: Path, threads: int = 0) -> dict[str, Any]:
    """Decode a tlog to columns: all messages, all fields and the times; by default on all cores."""
    log = mavstack.open_log(path, threads=threads)
    log.load()
    tables = {name: log[name] for name in log}
    for table in tables.values():
        for name in table.dtype.names or ():
            table[name]
    return tables


def tlog(path: Path, count: int, threads: int = 0) -> float:
    """Return the seconds per message of `columns`."""
    start = perf_counter()
    tables = columns(path, threads)
    end = perf_counter()
    return _seconds_per_message(sum(len(table) for table in tables.values()), count, start, end)


def stream(path: Path, size: int) -> int:
    """Parse a log of any size in chunks; return the number of messages."""
    parser, received = mavstack.Parser(ardupilotmega, timestamped=True), 0
    with path.open("rb") as file:
        while chunk := file.read(size):
            received += sum(packet.message is not None for packet in parser.feed(chunk))
    return received
