"""The package of `mav gen python` beside pymavlink's generated module, and the time of generation.

pymavlink uses the compiled checksum of fastcrc, its dependency; our package only the standard library.
"""

from __future__ import annotations

import importlib
import sys
from functools import partial
from operator import attrgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any

from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect

from . import peers_pymavlink
from .codegen_generation import generation
from .measure import OURS, PYMAVLINK, Row, rates, speed_ratio, take_turns
from .mix import PROFILES
from .rows import CHUNK

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path
    from types import ModuleType

    from .rows import Bench

TARGET = 3.0
PACKAGE = "mavlink_ardupilotmega"


def rows(bench: Bench) -> Iterator[Row]:
    """Yield the rows of the parser, the encoder and the generator."""
    package = _package(bench.folder / "generated-python")
    count, turns = bench.amounts.slow, bench.amounts.turns
    chunks = bench.flight.chunks(CHUNK, count)
    values = [(index, *(index % 4096 * 0.0007 + offset for offset in range(6))) for index in range(count)]
    works: dict[str, tuple[Callable[..., float], Callable[..., float], tuple[object, ...]]] = {
        "Python: live stream, three fields of each": (peers_pymavlink.live, live, (chunks, count)),
        "Python: fields to packet (ATTITUDE)": (peers_pymavlink.encode, encode, (values,)),
    }
    for name, (theirs, ours, arguments) in works.items():
        results = take_turns(
            {PYMAVLINK: partial(theirs, *arguments), OURS: partial(ours, package, *arguments)}, turns
        )
        yield Row(name, rates(results), (speed_ratio(results, PYMAVLINK, TARGET),))
    yield generation("Python", "python", "Python", bench, PYMAVLINK)


def _package(folder: Path) -> ModuleType:
    write_files(generate(make_library(Dialect.load("ardupilotmega")), "python"), folder)
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(PACKAGE)
    finally:
        sys.path.remove(str(folder))


def live(package: ModuleType, chunks: list[bytes], count: int) -> float:
    """Parse chunks of a stream to messages, and read three fields of each."""
    by_name = {kind.NAME: kind for kind in package.messages.BY_ID.values()}
    read: dict[type, Any] = {by_name[item.name]: attrgetter(*item.read_fields) for item in PROFILES}
    parser, received = package.Parser(), 0
    start = perf_counter()
    for chunk in chunks:
        packets = parser.feed(chunk)
        for packet in packets:
            message = packet.message
            read[type(message)](message)
        received += len(packets)
    seconds = perf_counter() - start
    if received != count:
        raise RuntimeError(f"the package received {received} of {count} messages")
    return seconds / count


def encode(package: ModuleType, values: list[tuple[Any, ...]]) -> float:
    """Encode the seven fields of ATTITUDE to packets."""
    attitude, sequence = package.messages.Attitude, 0
    start = perf_counter()
    for boot, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed in values:
        attitude(boot, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed).pack(1, 1, sequence)
        sequence = (sequence + 1) & 255
    return (perf_counter() - start) / len(values)
