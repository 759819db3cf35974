"""Start, memory and processor time of routers at the rate of one vehicle, as ratios to mavlink-router.

The floor is a Python program that has imported asyncio and does nothing. Programs run with cached bytecode,
as installed packages do. The routers run at once and get their packets in turns, so that both find the
machine in the same state, and their clients read what they get. One start of all does not count.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from contextlib import ExitStack
from itertools import product
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
#: Distance of the ports of two routers.
PORTS = 100
#: The program of a client, which prints a line when it reads.
CLIENT = """
import socket, sys
client = socket.socket(fileno=int(sys.argv[1]))
print(flush=True)
while True:
    client.recv(65536)
"""
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
        turns = [measure(commands, clients) for _ in range(options.turns + 1)][1:]
        _print(
            clients, {name: _median([turn[name] for turn in turns]) for name in commands}, _memory_of_floor()
        )


def _commands(options: argparse.Namespace, clients: int) -> dict[str, Sequence[str]]:
    """Return the command of each program, which uses the ports of its number."""
    places = [f"{HOST}:{TO + client}" for client in range(clients)]
    ours = [word for place in places for word in ("-e", f"udpout://{place}")]
    found: dict[str, Sequence[str]] = {
        "mav route": [sys.executable, "-m", "mavstack", "route", "-e", f"udpin://{HOST}:{LISTEN}", *ours]
    }
    if options.mavlink_router:
        places = [f"{HOST}:{TO + PORTS + client}" for client in range(clients)]
        theirs = [word for place in places for word in ("-e", place)]
        found["mavlink-router"] = [options.mavlink_router, "-t", "0", *theirs, f"{HOST}:{LISTEN + PORTS}"]
    return found


def _median(turns: Sequence[Footprint]) -> Footprint:
    return Footprint(*(median(figures) for figures in zip(*turns, strict=True)))


def measure(commands: Mapping[str, Sequence[str]], clients: int) -> dict[str, Footprint]:
    """Start the routers one after the other, and send packets through all of them in turns."""
    ports = [LISTEN + PORTS * number for number in range(len(commands))]
    with ExitStack() as stack:
        for port in ports:
            for client in range(clients):
                _run_client(stack, port - LISTEN + TO + client)
        started = [_run(stack, command, port) for command, port in zip(commands.values(), ports, strict=True)]
        sleep(IDLE)
        before = [processor_seconds(process) for process, _ in started]
        _send(ports)
        return {
            name: Footprint(start, _memory(process), (processor_seconds(process) - used) / DURATION)
            for name, (process, start), used in zip(commands, started, before, strict=True)
        }


def _run(stack: ExitStack, command: Sequence[str], port: int) -> tuple[int, float]:
    """Start a router; return its process and the seconds until its port was open."""
    null = subprocess.DEVNULL
    began = monotonic()
    process = stack.enter_context(
        subprocess.Popen(command, stdin=null, stdout=null, stderr=null, env=_environment())
    )
    stack.callback(process.kill)
    wait_until_bound(port, pause=0.01)
    return process.pid, monotonic() - began


def _run_client(stack: ExitStack, port: int) -> None:
    """Start a program that reads what comes to a port."""
    receiver = stack.enter_context(_udp_socket())
    receiver.bind((HOST, port))
    descriptor = receiver.fileno()
    command = [sys.executable, "-S", "-c", CLIENT, str(descriptor)]
    process = stack.enter_context(
        subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, pass_fds=[descriptor])
    )
    stack.callback(process.kill)
    if process.stdout is not None:
        process.stdout.readline()


def _udp_socket() -> socket.socket:
    return socket.socket(socket.AF_INET, socket.SOCK_DGRAM)


def _send(ports: Sequence[int]) -> None:
    """Send a vehicle's packets to each port, which get their packets at different times and change places."""
    encoder, began = Encoder(1, 1), monotonic()
    count, distance = int(PACKETS_PER_SECOND * DURATION), 1 / PACKETS_PER_SECOND / len(ports)
    packets = [encoder.encode(common.Attitude(time_boot_ms=number)) for number in range(count)]
    with _udp_socket() as sender:
        for number, place in product(range(count), range(len(ports))):
            sleep(max(0.0, began + (number * len(ports) + place) * distance - monotonic()))
            sender.sendto(packets[number], (HOST, ports[(number + place) % len(ports)]))


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
