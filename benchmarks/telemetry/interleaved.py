"""Ratios of CPU time in short windows: `python -m benchmarks.telemetry.interleaved [--rounds N]`.

The speed of a shared machine changes within seconds, and with it the cost of a wake-up. Turns of several
seconds compare receivers at different speeds. Here all receivers run at the same time, and get the telemetry
of one vehicle in turns of about a second, so that each round gives ratios within a few seconds. All get the
heartbeats; the other packets of the time between its windows are lost for a receiver, as on a radio link.
"""

from __future__ import annotations

import argparse
import os
import socket
import statistics
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING, Self

from benchmarks.measure import OURS, apart
from benchmarks.report import machine

from . import recording
from .receiver import BARE_READER, Method, Receiver, installed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .recording import TimedPacket

ROUNDS = 11
#: Seconds in which all receivers find the vehicle, of a window before it counts, of a window, and after it.
WARM_UP, LEAD, WINDOW, DRAIN = 4.0, 0.4, 1.0, 0.03
READER, MAVSDK = f"{OURS}, position at 10 Hz", "MAVSDK, telemetry"
NAMES = (BARE_READER, OURS, READER, MAVSDK)
#: Receivers, the peer of each, and the ratio that is the target.
RATIOS = ((OURS, BARE_READER, 0.7), (OURS, MAVSDK, 0.5), (READER, BARE_READER, 0.4), (READER, MAVSDK, 0.3))
HEADER = f"{'receiver':28}{'CPU µs per packet':>20}   least … most"


class Lane:
    """A receiver, and the socket of its vehicle."""

    def __init__(self, method: Method) -> None:
        self.name = method.name
        self.receiver = Receiver(method)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(("127.0.0.1", self.receiver.port))
        #: CPU seconds per packet of each window.
        self.windows: list[float] = []

    def send(self, data: bytes) -> None:
        """Send a packet; a receiver that has ended is found when it is asked for its CPU time."""
        try:
            self._socket.send(data)
        except ConnectionRefusedError:
            return

    def __enter__(self) -> Self:
        self.receiver.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self.receiver.__exit__(None, None, None)


class Schedule:
    """The sender: one vehicle, whose packets go to a lane, and whose heartbeats go to all."""

    def __init__(self, packets: Sequence[TimedPacket], lanes: Sequence[Lane]) -> None:
        self._packets = packets
        self._lanes = lanes
        self._index = 0
        self._origin = time.perf_counter() - packets[0].time

    def send(self, seconds: float, *receiving: Lane) -> int:
        """Send for some seconds to some lanes; return the number of packets for each."""
        end, first = time.perf_counter() + seconds, self._index
        while (at := self._packets[self._index].time + self._origin) < end:
            packet = self._packets[self._index]
            time.sleep(max(0.0, at - time.perf_counter()))
            for lane in self._lanes if packet.message_id == recording.HEARTBEAT else receiving:
                lane.send(packet.data)
            self._index += 1
        return self._index - first


def measure(methods: Sequence[Method], rounds: int) -> dict[str, list[float]]:
    """Return the CPU seconds per packet of each receiver in each round."""
    seconds = WARM_UP + rounds * len(methods) * (LEAD + WINDOW + 2 * DRAIN) + 5.0
    packets = recording.record(seconds)
    with ExitStack() as stack, apart():
        lanes = [stack.enter_context(Lane(method)) for method in methods]
        for lane in lanes:
            lane.receiver.connect()
        time.sleep(1.0)
        schedule = Schedule(packets, lanes)
        schedule.send(WARM_UP, *lanes)
        for number in range(rounds):
            turn = number % len(lanes)
            for lane in lanes[turn:] + lanes[:turn]:
                schedule.send(LEAD, lane)
                before = lane.receiver.cpu
                count = schedule.send(WINDOW, lane)
                schedule.send(DRAIN)
                lane.windows.append((lane.receiver.cpu - before) / count)
        return {lane.name: lane.windows for lane in lanes}


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, and print the medians and the ratios."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.telemetry.interleaved", description="Ratios of CPU time."
    )
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"rounds (default: {ROUNDS})")
    parser.add_argument(
        "--only", nargs="+", default=NAMES, help="names of receivers (default: those of ratios)"
    )
    options = parser.parse_args(arguments)
    measured = measure([method for method in installed() if method.name in options.only], options.rounds)
    print(HEADER)
    for name, windows in measured.items():
        print(f"{name:28}{_spread([cpu * 1e6 for cpu in windows], 1)}")
    for name, peer, target in RATIOS:
        if name in measured and peer in measured:
            ratios = [ours / theirs for ours, theirs in zip(measured[name], measured[peer], strict=True)]
            print(f"{name} / {peer}: {_spread(ratios, 2)}, must reach {target:g}")
    print(f"machine  {machine()}\nload     {os.getloadavg()[0]:.2f}")


def _spread(values: Sequence[float], digits: int) -> str:
    return f"{statistics.median(values):20.{digits}f}   {min(values):.{digits}f} … {max(values):.{digits}f}"


if __name__ == "__main__":
    main()
