"""Start, memory and processor time of routers at the rate of one vehicle, as ratios to mavlink-router.

The floor is a Python program that has imported asyncio and does nothing. Programs run with cached bytecode,
as installed packages do; the routers take turns after one start that does not count.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from time import monotonic, sleep
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.wire import Encoder

from .peers import HOST, LISTEN, TO
from .processes import processor_seconds, wait_until_bound

if TYPE_CHECKING:
    import argparse
    from collections.abc import Mapping, Sequence

PACKETS_PER_SECOND = 500
#: Numbers of programs to which the packets of the vehicle go.
CLIENTS = (1, 4)
DURATION = 5.0
IDLE = 2.0
FLOOR = "Python with asyncio"
BYTECODE = Path(__file__).parents[1] / ".build" / "bytecode"


class Footprint(NamedTuple):
    """Seconds until the port is open, resident memory in MB, and the part of a core that is used."""

    start: float
    memory: float
    load: float


def report(options: argparse.Namespace) -> None:
    """Measure all programs that are given, and print a table for each number of clients."""
    for clients in CLIENTS:
        commands = _commands(options, clients)
        turns: dict[str, list[Footprint]] = {name: [] for name in commands}
        for turn in range(options.turns + 1):
            for name, command in commands.items():
                found = measure(command, clients)
                if turn:
                    turns[name].append(found)
        _print(clients, {name: _median(found) for name, found in turns.items()}, _memory_of_floor())


def _commands(options: argparse.Namespace, clients: int) -> dict[str, Sequence[str]]:
    places = [f"{HOST}:{TO + number}" for number in range(clients)]
    ours = [word for place in places for word in ("-e", f"udpout://{place}")]
    found: dict[str, Sequence[str]] = {
        "mav route": [sys.executable, "-m", "mavstack", "route", "-e", f"udpin://{HOST}:{LISTEN}", *ours]
    }
    if options.mavlink_router:
        theirs = [word for place in places for word in ("-e", place)]
        found["mavlink-router"] = [options.mavlink_router, "-t", "0", *theirs, f"{HOST}:{LISTEN}"]
    return found


def _median(turns: Sequence[Footprint]) -> Footprint:
    return Footprint(*(median(figures) for figures in zip(*turns, strict=True)))


def measure(command: Sequence[str], clients: int) -> Footprint:
    """Run one router, and send packets through it."""
    null = subprocess.DEVNULL
    with ExitStack() as stack:
        sender, *receivers = [stack.enter_context(_udp_socket()) for _ in range(1 + clients)]
        for number, receiver in enumerate(receivers):
            receiver.bind((HOST, TO + number))
        environment, began = _environment(), monotonic()
        with subprocess.Popen(command, stdin=null, stdout=null, stderr=null, env=environment) as process:
            try:
                wait_until_bound(LISTEN, pause=0.01)
                start = monotonic() - began
                sleep(IDLE)
                before = processor_seconds(process.pid)
                _send(sender)
                load = (processor_seconds(process.pid) - before) / DURATION
                return Footprint(start, _memory(process.pid), load)
            finally:
                process.kill()


def _udp_socket() -> socket.socket:
    return socket.socket(socket.AF_INET, socket.SOCK_DGRAM)


def _send(sender: socket.socket) -> None:
    encoder, began = Encoder(1, 1), monotonic()
    for number in range(int(PACKETS_PER_SECOND * DURATION)):
        sleep(max(0.0, began + number / PACKETS_PER_SECOND - monotonic()))
        sender.sendto(encoder.encode(common.Attitude(time_boot_ms=number)), (HOST, LISTEN))


def _memory_of_floor() -> float:
    program = "import asyncio; print(flush=True); input()"
    pipe = subprocess.PIPE
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, env=_environment()) as process:
        try:
            if process.stdout is not None:
                process.stdout.readline()
            return _memory(process.pid)
        finally:
            process.kill()


def _environment() -> dict[str, str]:
    """Return the environment of a program whose bytecode is cached."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return environment | {"PYTHONPYCACHEPREFIX": str(BYTECODE)}


def _memory(process: int) -> float:
    lines = Path(f"/proc/{process}/status").read_text("ascii").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS:")) / 1024


def _print(clients: int, measured: Mapping[str, Footprint], floor: float) -> None:
    title = f"at {PACKETS_PER_SECOND} packets/s, clients: {clients}"
    print(f"{title:40}{'start s':>12}{'memory MB':>12}{'load %':>12}")
    for name, each in measured.items():
        print(f"{name:40}{each.start:12.2f}{each.memory:12.1f}{each.load * 100:12.2f}")
    print(f"{FLOOR:40}{'-':>12}{floor:12.1f}{'-':>12}")
    ours, *others = measured.values()
    for other in others:
        ratios = [mine / max(theirs, 1e-9) for mine, theirs in zip(ours, other, strict=True)]
        print(f"{'ratio':40}" + "".join(f"{ratio:12.2f}" for ratio in ratios))
    print(flush=True)
