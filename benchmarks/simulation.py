"""`python -m benchmarks.simulation [--seconds N] [--sitl NAME=COMMAND …]`: the cost of simulated vehicles.

Each line is a program that sends to a UDP port of this machine: `mav sim` with fleets of several sizes, and
with `--sitl` real autopilots in simulation, whose command contains `{port}`. A listener on another core sends
the heartbeat of a ground station once per second, and receives and counts all packets; the program is pinned
to one core. After its first heartbeat it runs for a settling time, and is then measured:

    start      from the start of the process to the first heartbeat
    CPU        of the process and its children, relative to real time: 100 % is one core
    memory     unique set size (USS), which excludes memory shared between processes
    msg/s      received from all vehicles, and the fraction lost, from the sequence numbers
    to a core  number of such vehicles that one core could run, from the CPU per vehicle
"""

from __future__ import annotations

import argparse
import os
import shlex
import signal
import socket
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.dialects import Dialect, common
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from collections.abc import Sequence

FLEETS = (1, 10, 50, 200)
SETTLE_TIME = 5.0
START_TIMEOUT = 60.0
_TICKS = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Measurement:
    """The measurements of one run."""

    start: float
    cpu: float
    memory: float
    rate: float
    lost: float
    vehicles: int


class Listener:
    """The ground station: receives and counts packets."""

    def __init__(self) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.05)
        self.port = self.socket.getsockname()[1]
        self.parser = Parser(Dialect.load("all"))
        self.packets = 0
        self.systems: set[int] = set()
        self.peers: set[tuple[str, int]] = set()
        self._encoder = Encoder(255, 190)
        self._next_heartbeat = 0.0

    def receive(self, seconds: float, *, until_heartbeat: bool = False) -> bool:
        """Receive for a number of seconds; return True at the first heartbeat if `until_heartbeat`."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._send_heartbeat()
            try:
                data, peer = self.socket.recvfrom(1 << 16)
            except TimeoutError:
                continue
            self.peers.add(peer)
            for packet in self.parser.feed(data):
                self.packets += 1
                if packet.message_id == 0 and packet.component == 1:
                    self.systems.add(packet.system)
                    if until_heartbeat:
                        return True
        return False

    @property
    def lost(self) -> int:
        """Number of packets lost between the vehicle and the listener."""
        return sum(source.lost for source in self.parser.sources.values())

    def _send_heartbeat(self) -> None:
        now = time.monotonic()
        if now >= self._next_heartbeat:
            self._next_heartbeat = now + 1.0
            heartbeat = common.Heartbeat(type=6, autopilot=8, system_status=4, mavlink_version=3)
            for peer in self.peers:
                self.socket.sendto(self._encoder.encode(heartbeat), peer)


def run(command: list[str], listener: Listener, seconds: float) -> Measurement:
    """Start a program, measure it, and end it."""
    started = time.monotonic()
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        _pin(process.pid)
        if not listener.receive(START_TIMEOUT, until_heartbeat=True):
            raise SystemExit(f"no heartbeat of {' '.join(command)} in {START_TIMEOUT:g} s")
        start = time.monotonic() - started
        listener.receive(SETTLE_TIME)
        before, packets, lost = _cpu(process.pid), listener.packets, listener.lost
        measured_from = time.monotonic()
        listener.receive(seconds)
        elapsed = time.monotonic() - measured_from
        received = listener.packets - packets
        return Measurement(
            start,
            (_cpu(process.pid) - before) / elapsed,
            _memory(process.pid),
            received / elapsed,
            (listener.lost - lost) / max(received, 1),
            len(listener.systems),
        )
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _pin(pid: int) -> None:
    cores = sorted(os.sched_getaffinity(0))
    if len(cores) > 1:
        os.sched_setaffinity(pid, {cores[-1]})
        os.sched_setaffinity(0, set(cores[:-1]))


def _process_tree(pid: int) -> list[int]:
    """Return a process and all its descendants."""
    pids = [pid]
    for each in pids:
        for task in Path(f"/proc/{each}/task").glob("*/children"):
            pids += [int(child) for child in task.read_text().split()]
    return pids


def _cpu(pid: int) -> float:
    """Return the processor time of a process tree in seconds."""
    total = 0
    for each in _process_tree(pid):
        fields = Path(f"/proc/{each}/stat").read_text().rpartition(")")[2].split()
        total += int(fields[11]) + int(fields[12])
    return total / _TICKS


def _memory(pid: int) -> float:
    """Return the unique memory of a process tree in megabytes."""
    total = 0
    for each in _process_tree(pid):
        for line in Path(f"/proc/{each}/smaps_rollup").read_text().splitlines():
            if line.startswith("Private_"):
                total += int(line.split()[1])
    return total / 1024


def ours(count: int, firmware: str) -> str:
    """Return the command line of a fleet of `mav sim`."""
    program = f"{shlex.quote(sys.executable)} -m mavstack sim"
    return f"{program} --count {count} --firmware {firmware} --out udpout://127.0.0.1:{{port}}"


def programs(options: argparse.Namespace) -> dict[str, str]:
    """Return the commands of all programs by name."""
    table = {
        f"mavstack, {count} {firmware}": ours(count, firmware)
        for firmware in ("ardupilot", "px4")
        for count in options.fleets
    }
    return table | dict(item.split("=", 1) for item in options.sitl)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure all programs, and print a table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.simulation", description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="duration of a measurement in seconds")
    parser.add_argument("--turns", type=int, default=3, help="runs of each program; the table shows medians")
    parser.add_argument("--fleets", type=int, nargs="+", default=FLEETS, help="numbers of vehicles")
    parser.add_argument(
        "--sitl",
        action="append",
        default=[],
        help="NAME=COMMAND of another autopilot; {port} in the command is replaced by the UDP port",
    )
    options = parser.parse_args(arguments)
    results: dict[str, list[Measurement]] = {}
    for _ in range(options.turns):
        for name, command in programs(options).items():
            listener = Listener()
            program_command = shlex.split(command.replace("{port}", str(listener.port)))
            results.setdefault(name, []).append(run(program_command, listener, options.seconds))
    _print(results)


def _print(results: dict[str, list[Measurement]]) -> None:
    head = f"{'program':<28}{'start':>8}{'CPU':>9}{'memory':>10}{'each':>9}"
    print(f"{head}{'msg/s':>9}{'lost':>7}{'to a core':>11}")
    for name, runs in results.items():
        count = statistics.median(run.vehicles for run in runs)
        start, cpu, memory, rate, lost = (
            statistics.median(getattr(run, field) for run in runs)
            for field in ("start", "cpu", "memory", "rate", "lost")
        )
        print(
            f"{name:<28}{start:>6.2f} s{cpu:>8.1%}{memory:>7.1f} MB{memory / max(count, 1):>6.2f} MB"
            f"{rate:>9.0f}{lost:>7.1%}{count / max(cpu, 1e-6):>11.0f}"
        )
        spread = [run.cpu for run in runs]
        print(f"{'':<28}{'':>8}{min(spread):>8.1%} … {max(spread):.1%}")


if __name__ == "__main__":
    main()
