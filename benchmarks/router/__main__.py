"""Routers between UDP ports: throughput without loss, processor time, delay, commands in a flood, footprint.

    python -m benchmarks.router [--only NAME …] [--packets 300000] [--turns 3]
        [--mavlink-router PROGRAM] [--mavp2p PROGRAM] [--mavproxy PROGRAM]

`load.c` sends DEBUG_VECT packets through each router, so many at a time that socket buffers lose none; and
then at 5,000 per second, for the delay. The bare relay is a loop of recvmmsg and sendmmsg in C. The routers
take turns; each figure is the median of the turns.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import sleep
from typing import TYPE_CHECKING

from . import flood, footprint
from .peers import LISTEN, TO, routers
from .processes import processor_seconds, wait_until_bound

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .peers import Router

HERE = Path(__file__).parent
DELAY_RATE, DELAY_PACKETS = 5000, 10_000
#: Seconds from the moment at which a router has opened its port until it has opened everything.
SETTLING_TIME = 0.5
BUFFERS = ("rmem_max", "rmem_default", "wmem_max", "wmem_default")


@dataclass(frozen=True, slots=True)
class Scenario:
    """One table.

    Attributes:
        title: Its head.
        window: Packets under way at a time.
        mixed: The packets have different lengths.
        endpoints: Number of endpoints that each packet goes to.
        buffers: Bytes of all socket buffers; 0: those of the system.
    """

    title: str
    window: int = 200
    mixed: bool = False
    endpoints: int = 1
    buffers: int = 0


SCENARIOS = {
    "equal": Scenario("packets of one length"),
    "mixed": Scenario("packets of mixed lengths", mixed=True),
    "large": Scenario("mixed lengths, socket buffers of 8 MB", window=4000, mixed=True, buffers=8 << 20),
    "endpoints": Scenario("200 endpoints: each packet goes to 199", mixed=True, endpoints=199),
}
FLOOD, FOOTPRINT = "flood", "footprint"
ALL = (*SCENARIOS, FLOOD, FOOTPRINT)
MAVLINK_ROUTER = os.environ.get("MAVLINK_ROUTERD") or shutil.which("mavlink-routerd")


@dataclass(frozen=True, slots=True)
class Turn:
    """One measurement: packets per second, processor time per packet and delays in microseconds."""

    rate: float
    processor: float
    delay: float
    late: float
    lost: int


def main() -> None:
    """Measure all routers, and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.router", description="Compare routers.")
    parser.add_argument("--only", nargs="+", choices=ALL, default=ALL)
    parser.add_argument("--packets", type=int, default=300_000, help="packets of a turn")
    parser.add_argument("--turns", type=int, default=3, help="turns of each router")
    parser.add_argument("--mavlink-router", default=MAVLINK_ROUTER, help="its program")
    parser.add_argument("--mavp2p", default=shutil.which("mavp2p"), help="its program")
    parser.add_argument("--mavproxy", default=shutil.which("mavproxy.py"), help="its program")
    options = parser.parse_args()
    if FOOTPRINT in options.only:
        footprint.report(options)
    if set(options.only) == {FOOTPRINT}:
        return
    load = build_load()
    for name, scenario in SCENARIOS.items():
        if name in options.only:
            compare(options, load, scenario)
    if FLOOD in options.only:
        flood.report(load)


def compare(options: argparse.Namespace, load: Path, scenario: Scenario) -> None:
    """Measure one scenario, and print its table."""
    programs = routers(options, load, scenario.endpoints)
    turns: dict[str, list[Turn]] = {name: [] for name in programs}
    with socket_buffers(scenario.buffers):
        for _ in range(options.turns):
            for name, router in programs.items():
                turns[name].append(measure(load, router, scenario, options.packets))
    print(f"{scenario.title:40}{'packets/s':>12}{'us/packet':>12}{'median us':>12}{'p99 us':>12}{'lost':>8}")
    for name, measured in turns.items():
        values = [
            median(getattr(turn, field) for turn in measured)
            for field in ("rate", "processor", "delay", "late")
        ]
        lost = sum(turn.lost for turn in measured)
        print(f"{name:40}{values[0]:12,.0f}{values[1]:12.2f}{values[2]:12.1f}{values[3]:12.1f}{lost:8}")
    print(flush=True)


def build_load() -> Path:
    """Compile the load into the folder that git ignores."""
    compiler = shutil.which("gcc") or sys.exit("the benchmark of routers needs gcc")
    folder = HERE.parent / ".build"
    folder.mkdir(exist_ok=True)
    program = folder / "router-load"
    subprocess.run([compiler, "-O2", "-pthread", "-o", str(program), str(HERE / "load.c")], check=True)
    return program


def measure(load: Path, router: Router, scenario: Scenario, packets: int) -> Turn:
    """Run the load through one router."""
    copies = scenario.endpoints
    count = int(packets * router.share) // copies
    with running(router.command) as process:
        before = processor_seconds(process.pid)
        mode = (scenario.window, count, copies, int(scenario.mixed))
        result = run_load(load, "throughput", LISTEN, TO, *mode)
        seconds = processor_seconds(process.pid) - before
        delays = {"median": 0.0, "p99": 0.0}
        if copies == 1:
            delays = run_load(load, "delay", LISTEN, TO, DELAY_RATE, DELAY_PACKETS)
    received = max(1, int(result["received"]))
    return Turn(
        rate=received / result["seconds"],
        processor=seconds / received * 1e6,
        delay=delays["median"],
        late=delays["p99"],
        lost=int(result["lost"]),
    )


def run_load(load: Path, mode: str, *numbers: int) -> dict[str, float]:
    """Run the load in a mode, and return its result."""
    command = [str(load), mode, *map(str, numbers)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)
    result: dict[str, float] = json.loads(done.stdout)
    return result


@contextmanager
def running(command: Sequence[str]) -> Iterator[subprocess.Popen[bytes]]:
    """Run a router."""
    null, pipe = subprocess.DEVNULL, subprocess.PIPE
    with subprocess.Popen(command, cwd=HERE.parents[1], stdin=pipe, stdout=null, stderr=null) as process:
        try:
            wait_until_bound(LISTEN)
            sleep(SETTLING_TIME)
            yield process
        finally:
            process.kill()


@contextmanager
def socket_buffers(size: int) -> Iterator[None]:
    """Give all new sockets of the system buffers of a size, which needs root; 0: change nothing."""
    settings = [Path("/proc/sys/net/core") / name for name in BUFFERS] if size else []
    before = [setting.read_text("utf-8") for setting in settings]
    try:
        for setting in settings:
            setting.write_text(str(size), "utf-8")
        yield
    finally:
        for setting, value in zip(settings, before, strict=True):
            setting.write_text(value, "utf-8")


if __name__ == "__main__":
    main()
