"""Data of companion computers: the row `companion`.

Programs run as children (`companion_programs.py`); this process is the vehicle at the other end of a UDP
socket, or the receiver of air traffic. The processor time is that of the child with all its threads.

- odometry at 50 Hz, after two seconds of it: share of a core, and the age at the vehicle; beside MAVSDK and
  pymavlink;
- 1,000 aircraft with two lines of SBS a second each: share of a core (no peer reads a receiver);
- 1,000 CAN frames a second in each direction to a program of python-can: frames that are lost;
- corrections of 800 B/s over a simulated radio of 57,600 baud: the 95th percentile of the delay of commands,
  with corrections and without; beside MAVSDK's Rtk plugin, and pymavlink with fragments sent at once, as
  MAVProxy's modules do. No MAVProxy: what it sends for a line of its console cannot be timed.
"""

from __future__ import annotations

import json
import math
import socket
import statistics
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any, Final, Self

from mavstack import Parser, encode
from mavstack.dialects import Dialect, common
from mavstack.sim import BackgroundSimulator

from .measure import OURS, PYMAVLINK, Ratio, Row

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message

    from .rows import Bench

MAVSDK: Final = "MAVSDK"
#: Share of a core, and seconds, that odometry at 50 Hz may cost; the share for the aircraft.
MAX_ODOMETRY, MAX_AGE, MAX_TRAFFIC = 0.02, 0.005, 0.05
#: Seconds by which corrections may delay commands.
MAX_GROWTH: Final = 0.05
AIRCRAFT: Final = 1000
CAN_RATE: Final = 1000
#: Seconds of commands over the radio, three in a second: the 95th percentile of fewer is chance.
_CORRECTED: Final = 60.0
#: Frames of the vehicle are sent in bunches, since sleeps are not exact.
_BUNCH: Final = 10


def rows(bench: Bench) -> Iterator[Row]:
    """Measure odometry, aircraft, CAN frames and corrections."""
    seconds = 10.0 if bench.amounts.turns < 11 else 20.0
    yield odometry_row(seconds)
    yield aircraft_row(seconds)
    yield can_row(seconds)
    yield corrections_row(_CORRECTED if bench.amounts.turns < 11 else 2 * _CORRECTED)


def odometry_row(seconds: float) -> Row:
    """Measure odometry at 50 Hz of three programs."""
    figures, shares, ages = {}, {}, {}
    for name, program in ((OURS, "odometry"), (MAVSDK, "odometry-mavsdk"), (PYMAVLINK, "odometry-pymavlink")):
        with _Vehicle() as vehicle:
            shares[name] = _run(program, vehicle.port, seconds)["share"]
            ages[name] = _percentile(vehicle.ages)
        figures[name] = f"{shares[name]:.2%} of a core, age {ages[name] * 1e3:.2f} ms (95 %)"
    return Row(
        "odometry at 50 Hz",
        figures,
        (
            Ratio(f"of {MAX_ODOMETRY:.0%} of a core", (shares[OURS] / MAX_ODOMETRY,), 1, False),
            Ratio(f"of {MAX_AGE * 1e3:g} ms", (ages[OURS] / MAX_AGE,), 1, False),
            Ratio(f"share of {MAVSDK}", (shares[OURS] / shares[MAVSDK],), None, False),
            Ratio(f"share of {PYMAVLINK}", (shares[OURS] / shares[PYMAVLINK],), None, False),
        ),
    )


def aircraft_row(seconds: float) -> Row:
    """Measure a thousand aircraft of a receiver, shown to one vehicle."""
    with BackgroundSimulator() as simulator, _receiver() as port:
        found = _run("traffic", simulator.url, seconds, f"sbs://127.0.0.1:{port}")
    share = found["share"]
    text = f"{share:.2%} of a core, {found['reports'] / seconds:.0f} reports/s, {found['aircraft']} aircraft"
    ratio = Ratio(f"of {MAX_TRAFFIC:.0%} of a core", (share / MAX_TRAFFIC,), 1, False)
    return Row(f"{AIRCRAFT:,} aircraft over SBS", {OURS: text}, (ratio,))


def can_row(seconds: float) -> Row:
    """Measure CAN frames in both directions."""
    with _Vehicle(can_frames=round(CAN_RATE * seconds)) as vehicle:
        found = _run("can", vehicle.port, seconds)
        down, up = vehicle.can_frames - found["received"], found["sent"] - vehicle.can_received
    ratio = Ratio("frames lost", (float(down + up),), 0, False)
    figures = {OURS: f"{down} and {up} of {vehicle.can_frames} lost"}
    return Row(f"{CAN_RATE:,} CAN frames/s down and up", figures, (ratio,))


def corrections_row(seconds: float) -> Row:
    """Measure the delay that corrections add to commands over a radio, with all programs at the same time."""
    programs = {OURS: "corrections", MAVSDK: "corrections-mavsdk", PYMAVLINK: "corrections-pymavlink"}
    with ThreadPoolExecutor() as pool:
        delays = dict(zip(programs, pool.map(partial(_over_radio, seconds), programs.values()), strict=True))
    figures, growth = {}, {}
    for name, (without, corrected) in delays.items():
        before, after = _percentile(without), _percentile(corrected)
        growth[name] = after - before
        figures[name] = f"{before * 1e3:.0f} to {after * 1e3:.0f} ms (95 % of {len(corrected)})"
    ratio = Ratio(f"of {MAX_GROWTH * 1e3:g} ms more", (growth[OURS] / MAX_GROWTH,), 1, False)
    return Row("RTCM of 800 B/s over 57,600 baud", figures, (ratio,))


def _over_radio(seconds: float, program: str) -> tuple[list[float], list[float]]:
    """Return the delays of a program's commands without corrections and with them."""
    with BackgroundSimulator(link="udpin://127.0.0.1:0?idle=600&radio=sik") as simulator:
        found = _run(program, simulator.url, seconds)
    return found["without"], found["with"]


def _percentile(values: list[float]) -> float:
    return statistics.quantiles(values, n=20)[18] if len(values) > 1 else math.nan


def _run(program: str, target: int | str, seconds: float, *words: str) -> dict[str, Any]:
    """Run a program; return the object that it prints."""
    command = [
        sys.executable,
        "-m",
        "benchmarks.companion_programs",
        program,
        str(target),
        str(seconds),
        *words,
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=seconds * 4 + 60, check=False)
    if done.returncode:
        raise RuntimeError(f"{program}: {done.stderr.strip()[-500:]}")
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


class _Vehicle:
    """An autopilot on a UDP socket: heartbeats, acknowledgements, CAN frames, and ages of odometry."""

    def __init__(self, *, can_frames: int = 0) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            self.port: int = probe.getsockname()[1]
        self.can_frames = can_frames
        self.can_received = 0
        self.ages: list[float] = []
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        self._socket.connect(("127.0.0.1", self.port))
        self._socket.settimeout(0.2)
        self._ended = threading.Event()
        self._sequence = 0
        self._forwards = threading.Event()
        self._threads = [threading.Thread(target=each) for each in (self._receive, self._beat, self._forward)]

    def __enter__(self) -> Self:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        for thread in self._threads:
            thread.join()
        self._socket.close()

    def _send(self, message: Message) -> None:
        self._sequence = (self._sequence + 1) & 255
        try:
            self._socket.send(encode(message, system=1, component=1, sequence=self._sequence))
        except OSError:  # the program does not listen yet
            time.sleep(0.01)

    def _beat(self) -> None:
        while not self._ended.wait(0.2):
            self._send(common.Heartbeat(type=2, autopilot=12, system_status=3))

    def _receive(self) -> None:
        parser = Parser(Dialect.load("common"))
        while not self._ended.is_set():
            try:
                data = self._socket.recv(65_536)
            except OSError:
                continue
            now = time.time()
            for packet in parser.feed(data):
                match packet.message:
                    case common.Odometry(time_usec=moment):
                        self.ages.append(now - moment / 1e6)
                    case common.CanFrame():
                        self.can_received += 1
                    case common.CommandLong(command=command):
                        self._send(common.CommandAck(command=command, result=0))
                        if command == common.MavCmd.CAN_FORWARD:
                            self._forwards.set()

    def _forward(self) -> None:
        while not self._forwards.wait(0.1):
            if self._ended.is_set():
                return
        time.sleep(0.5)
        due = time.monotonic()
        for number in range(self.can_frames):
            self._send(common.CanFrame(bus=0, len=8, id=0x8000_0000 | number & 0xFFFF, data=bytes(8)))
            if number % _BUNCH == 0:
                due += _BUNCH / CAN_RATE
                time.sleep(max(due - time.monotonic(), 0))


@contextmanager
def _receiver() -> Iterator[int]:
    """Offer a thousand aircraft around the place of simulated vehicles, as dump1090 does."""
    ended = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(30)

        def serve() -> None:
            connection, _ = server.accept()
            with connection:
                step = 0
                while not ended.wait(0.1):
                    step += 1
                    with suppress(OSError):  # the program has ended
                        connection.sendall(b"".join(map(_lines, range(step % 10, AIRCRAFT, 10))))

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        try:
            yield server.getsockname()[1]
        finally:
            ended.set()
            thread.join(5)


def _lines(number: int) -> bytes:
    latitude, longitude = 47.4 + number % 40 / 100, 8.5 + number // 40 / 100
    head = f"1,1,{0x400000 + number:06X},1,,,,,"
    position = f"MSG,3,{head},{3000 + number * 10},,,{latitude:.4f},{longitude:.4f},,,0,0,0,0\r\n"
    return (position + f"MSG,4,{head},,250,{number % 360},,,0,,,,,\r\n").encode()
