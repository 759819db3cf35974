"""`python -m benchmarks.tracked [--turns N] [--rate N]`: packets per second that one core tracks."""

from __future__ import annotations

import argparse
import json
import os
import socket
import statistics
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.datagrams import BATCH, Batch, batches
from benchmarks.measure import apart
from benchmarks.report import machine

from .packets import Part, packets

TURNS = 3
#: Packets from memory; their boot times take a second, as the measurement about does.
MEMORY_RATE = 1_500_000
RATE, SECONDS = 320_000, 3.0
#: The vehicle is found before the rate is full. Only whole batches are sent.
FIRST = Part(1.0, 157 * BATCH)
STEP = 0.001


def _start(*arguments: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "benchmarks.tracked.receiver", *map(str, arguments)]
    folder = Path(__file__).parents[2]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=folder)


def _line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    return process.stdout.readline()


def _command(process: subprocess.Popen[str]) -> None:
    assert process.stdin is not None
    process.stdin.write("\n")
    process.stdin.flush()


def _from_memory() -> dict[str, float]:
    with _start("memory", MEMORY_RATE) as receiver:
        figures: dict[str, float] = json.loads(_line(receiver))
    return figures


def _over_udp(parts: list[Part], sent: list[list[Batch]]) -> dict[str, float]:
    with _start("udp") as receiver, apart(), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", int(_line(receiver))))
        for part, datagrams in zip(parts, sent, strict=True):
            _send(datagrams, part.rate, sock)
            _command(receiver)
        figures: dict[str, float] = json.loads(_line(receiver))
    return figures


def _from_first(sent: list[Batch], rate: int) -> dict[str, float]:
    with _start("first") as receiver, apart(), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", int(_line(receiver))))
        _command(receiver)
        _send(sent, rate, sock)
        _command(receiver)
        figures: dict[str, float] = json.loads(_line(receiver))
    return figures


def _send(sent: list[Batch], rate: int, sock: socket.socket) -> None:
    began = time.perf_counter()
    for number, batch in enumerate(sent):
        ahead = began + number * BATCH / rate - time.perf_counter()
        if ahead > 0:
            time.sleep(max(ahead, STEP))
        batch.send(sock)


def _print(name: str, turns: list[dict[str, float]]) -> None:
    rates, cpu = [turn["rate"] for turn in turns], statistics.median(turn["cpu"] for turn in turns)
    lost, dropped = (sum(turn[key] for turn in turns) for key in ("lost", "dropped"))
    spread = f"{min(rates):,.0f} … {max(rates):,.0f}"
    print(f"{name}  {statistics.median(rates):11,.0f}  {spread}  {cpu:.2f}  {lost}  {dropped}")


def main() -> None:
    """Run the benchmark, and print its rows."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.tracked", description="Latest values at full rate."
    )
    parser.add_argument("--turns", type=int, default=TURNS, help=f"turns of each row (default: {TURNS})")
    parser.add_argument(
        "--rate", type=int, default=RATE, help=f"packets per second over UDP (default: {RATE})"
    )
    options = parser.parse_args()
    parts = [FIRST, Part(SECONDS, options.rate)]
    sent = [batches(datagrams) for datagrams in packets(*parts)]
    print("packets from  packets/s  min … max  CPU µs  lost  dropped")
    _print("memory    ", [_from_memory() for _ in range(options.turns)])
    _print("UDP       ", [_over_udp(parts, sent) for _ in range(options.turns)])
    _print("UDP, first", [_from_first(sent[1], options.rate) for _ in range(options.turns)])
    print(f"machine  {machine()}\nload     {os.getloadavg()[0]:.2f}")


if __name__ == "__main__":
    main()
