"""`python -m benchmarks.fleets [--seconds N] [--growth] [--plot FILE]`."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from benchmarks.report import machine

SECONDS = 6.0


@dataclass(frozen=True, slots=True)
class Fleet:
    """Vehicles of each connection, their messages per second, and the subscriptions of the program."""

    vehicles: int
    rate: int
    connections: int = 1
    subscriptions: int = 0

    @property
    def packets(self) -> int:
        """Packets per second."""
        return self.vehicles * self.rate * self.connections


FLEETS = (Fleet(1, 400), Fleet(200, 110), Fleet(200, 100, 5))
#: Fleets of one rate of packets: a packet costs the same if nothing grows with the number.
GROWTH = (*(Fleet(count, 100) for count in (10, 50, 200)), Fleet(200, 100, 5))
SUBSCRIBED = tuple(Fleet(50, 100, 1, count) for count in (1, 10, 50, 200))


@dataclass(frozen=True, slots=True)
class Figures:
    """The figures of a receiver: packets, losses, CPU time of a packet in microseconds, memory in MB."""

    received: int
    lost: int
    cpu: float
    memory: float


def measure(method: str, fleet: Fleet, seconds: float) -> tuple[Figures, int]:
    """Return the figures of a receiver, and the number of packets that were sent to it."""
    numbers = (fleet.connections, fleet.vehicles, fleet.subscriptions)
    with _start("receiver", method, *numbers) as receiver:
        ports = _line(receiver).split()
        with _start("sender", seconds, fleet.vehicles, fleet.rate, *ports) as sender:
            _line(sender)
            _command(sender)
            _command(receiver)
            sent = int(_line(sender))
        _command(receiver)
        return Figures(**json.loads(_line(receiver))), sent * fleet.connections


def _start(module: str, *arguments: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", f"benchmarks.fleets.{module}", *map(str, arguments)]
    folder = Path(__file__).parents[2]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=folder)


def _line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    return process.stdout.readline()


def _command(process: subprocess.Popen[str]) -> None:
    assert process.stdin is not None
    process.stdin.write("\n")
    process.stdin.flush()


def _print_fleets(seconds: float) -> None:
    print("vehicles  packets/s  reader    CPU µs  cores  of bare  memory MB  lost  at the start")
    for fleet in FLEETS:
        bare, sent = measure("bare", fleet, seconds)
        _print(fleet, "blocking", bare, sent, 1.0)
        ours, sent = measure("ours", fleet, seconds)
        _print(fleet, "mavstack", ours, sent, ours.cpu / bare.cpu)


def _print(fleet: Fleet, name: str, figures: Figures, sent: int, ratio: float) -> None:
    vehicles, cores = fleet.vehicles * fleet.connections, figures.cpu * fleet.packets / 1e6
    print(
        f"{vehicles:8}  {fleet.packets:9,}  {name}  {figures.cpu:6.2f}  {cores:5.3f}  {ratio:7.2f}"
        f"  {figures.memory:9.0f}  {figures.lost:4}  {sent - figures.received - figures.lost}",
        flush=True,
    )


def _growth(fleets: tuple[Fleet, ...], seconds: float) -> list[float]:
    costs = []
    for fleet in fleets:
        figures, sent = measure("ours", fleet, seconds)
        _print(fleet, "mavstack", figures, sent, 1.0)
        costs.append(figures.cpu)
    return costs


def _draw(path: Path, vehicles: list[float], subscribed: list[float]) -> None:
    from matplotlib import pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3), sharey=True, layout="constrained")
    left.plot([fleet.vehicles * fleet.connections for fleet in GROWTH], vehicles, "o-")
    left.set(
        xscale="log",
        xlabel="vehicles, 100 messages/s each",
        ylabel="CPU time of a packet, µs",
        ylim=(0, None),
    )
    right.plot([fleet.subscriptions for fleet in SUBSCRIBED], subscribed, "o-")
    right.set(xscale="log", xlabel="subscriptions to one message of 50 vehicles")
    figure.savefig(path)


def main() -> None:
    """Run the benchmark, and print its rows."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleets", description="Many vehicles.")
    parser.add_argument("--seconds", type=float, default=SECONDS, help=f"of a turn (default: {SECONDS:g})")
    parser.add_argument(
        "--growth", action="store_true", help="by the number of vehicles, and of subscriptions"
    )
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw the growth")
    options = parser.parse_args()
    if options.growth or options.plot:
        costs = _growth(GROWTH, options.seconds), _growth(SUBSCRIBED, options.seconds)
        if options.plot:
            _draw(options.plot, *costs)
    else:
        _print_fleets(options.seconds)
    print(f"machine  {machine()}\nload     {os.getloadavg()[0]:.2f}")


if __name__ == "__main__":
    main()
