"""The package of `mav gen python` beside pymavlink's generated module, and the time of generation.

pymavlink uses the compiled checksum of fastcrc, its dependency; our package only the standard library.
"""

from __future__ import annotations

import importlib
import subprocess
import sys
from functools import partial
from operator import attrgetter
from time import monotonic_ns, perf_counter
from typing import TYPE_CHECKING, Any

from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect

from . import c_library, peers_pymavlink
from .measure import OURS, PYMAVLINK, Row, rates, speed_ratio, take_turns
from .mix import PROFILES
from .rows import CHUNK

if TYPE_CHECKING:
    from collections.abc import Iterator
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
    works = {
        "Python: live stream, three fields of each": (peers_pymavlink.live, live, (chunks, count)),
        "Python: fields to packet (ATTITUDE)": (peers_pymavlink.encode, encode, (values,)),
    }
    for name, (theirs, ours, arguments) in works.items():
        results = take_turns(
            {PYMAVLINK: partial(theirs, *arguments), OURS: partial(ours, package, *arguments)}, turns
        )
        yield Row(name, rates(results), (speed_ratio(results, PYMAVLINK, TARGET),))
    yield _generation(bench)


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


def _generation(bench: Bench) -> Row:
    """Return the time from the command line to the last file, for all messages."""
    peer = [sys.executable, "-m", "pymavlink.tools.mavgen", "--no-validate", "--lang", "Python"]
    definition = str(c_library.DEFINITIONS / "all.xml")

    def theirs() -> float:
        output = str(bench.folder / f"mavgen-{monotonic_ns()}.py")
        return _seconds([*peer, "--wire-protocol", "2.0", "-o", output, definition])

    def ours() -> float:
        output = str(bench.folder / f"mavstack-{monotonic_ns()}")
        return _seconds([sys.executable, "-m", "mavstack", "gen", "python", "all", "-o", output])

    results = take_turns({PYMAVLINK: theirs, OURS: ours}, bench.amounts.turns)
    figures = {library: f"{sorted(times)[len(times) // 2]:.2f} s" for library, times in results.items()}
    return Row("Python: generation of all", figures, (speed_ratio(results, PYMAVLINK, 1.0),))


def _seconds(command: list[str]) -> float:
    start = perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return perf_counter() - start
