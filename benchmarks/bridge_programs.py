"""Whole bridge programs under load: delay and processor time, the row `bridge-programs`.

Vehicles on one UDP socket send ATTITUDE, numbered by `rollspeed`; a subscriber behind a
Zenoh router in the same process notes when each number arrives. The processor time is that of the bridge's
process with all its threads, from `/proc`.
"""

from __future__ import annotations

import json
import os
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack import Parser, encode
from mavstack.dialects import Dialect, common

from .measure import OURS, Ratio, Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from .rows import Bench

#: Milliseconds that a bridge may add: median and 99th percentile.
MAX_MEDIAN, MAX_TAIL = 1.5, 10.0
#: Vehicles, their messages a second, and the share of a core that they may cost.
VEHICLES, RATE, MAX_SHARE = 100, 50, 0.15
#: Messages a second of the vehicle whose delay is measured.
DELAY_RATE: Final = 200
#: The first of three angular velocities, before 21 more numbers at the end of an Imu message.
_FIRST_RATE: Final = struct.Struct("<d")
_FROM_END: Final = -8 * (21 + 3)
#: Seconds before the measurement: a bridge finds its vehicles and declares their endpoints in the first ones.
_WARM_UP: Final = 12.0
_NUMBERS: Final = 1 << 20
#: Installed packages have bytecode; that of the work tree is kept here.
_BYTECODE: Final = Path(tempfile.gettempdir()) / f"mavstack-bytecode-{os.getuid()}"


def rows(bench: Bench) -> Iterator[Row]:
    """Measure delay and processor time of `mav bridge zenoh` and `mav bridge ros2`."""
    try:
        import zenoh
    except ImportError:
        yield Row("bridge programs", {OURS: "zenoh is not installed"}, ())
        return
    seconds = max(5.0, bench.amounts.slow / 5000)
    share = _Run(zenoh, "zenoh", "mavstack/*/frame/out", _of_frames, range(1, VEHICLES + 1), RATE, seconds)
    yield Row(
        f"{VEHICLES} vehicles at {RATE} messages/s over Zenoh: a core's share, delay",
        {OURS: f"{share.share:.3f}, {share.delays}"},
        (Ratio(f"of {MAX_SHARE:g}", (MAX_SHARE / share.share,), 1.0), *share.ratios),
    )
    for name, key, decode in (
        ("zenoh", "mavstack/*/frame/out", _of_frames),
        ("ros2", "**/imu/data/**", _of_imu),
    ):
        run = _Run(zenoh, name, key, decode, (1,), DELAY_RATE, seconds)
        yield Row(
            f"delay through mav bridge {name}: median, 99th percentile",
            {OURS: run.delays},
            run.ratios,
        )


def _of_frames(payload: bytes, parser: Parser) -> Iterator[int]:
    for packet in parser.feed(payload):
        if isinstance(message := packet.message, common.Attitude):
            yield int(message.rollspeed)


def _of_imu(payload: bytes, parser: Parser) -> Iterator[int]:
    yield int(_FIRST_RATE.unpack_from(payload, len(payload) + _FROM_END)[0])


class _Run:
    """One run of a bridge."""

    def __init__(
        self,
        zenoh: Any,  # noqa: ANN401 (it has no base class)
        name: str,
        key: str,
        decode: Callable[[bytes, Parser], Iterator[int]],
        systems: Sequence[int],
        rate: int,
        seconds: float,
    ) -> None:
        self._arrivals: dict[int, float] = {}
        self._parser, self._decode = Parser(Dialect.load("all")), decode
        with router(zenoh) as (session, endpoint), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            subscriber = session.declare_subscriber(key, self._arrived)
            address = ("127.0.0.1", free_port())
            with bridge(name, address[1], endpoint) as process:
                _send(out, address, systems, rate, _WARM_UP, 0)
                used, begun = _processor_time(process), time.monotonic()
                times = _send(out, address, systems, rate, seconds, 100_000)
                self.share = (_processor_time(process) - used) / (time.monotonic() - begun)
                time.sleep(0.5)
            subscriber.undeclare()
        delays = [
            1e3 * (self._arrivals[each] - sent) for each, sent in times.items() if each in self._arrivals
        ]
        self.sent, self.lost = len(times), len(times) - len(delays)
        self.median = statistics.median(delays)
        self.tail = statistics.quantiles(delays, n=100)[98]

    @property
    def delays(self) -> str:
        """The median and the 99th percentile, and the number of lost messages."""
        return f"{self.median:.2f}, {self.tail:.2f} ms, {self.lost} of {self.sent} lost"

    @property
    def ratios(self) -> tuple[Ratio, Ratio]:
        """The limits of the delays, over the delays."""
        return (
            Ratio(f"of {MAX_MEDIAN:g} ms", (MAX_MEDIAN / self.median,), 1.0),
            Ratio(f"of {MAX_TAIL:g} ms", (MAX_TAIL / self.tail,), 1.0),
        )

    def _arrived(self, sample: Any) -> None:  # noqa: ANN401 (it has no base class)
        now = time.perf_counter()
        for number in self._decode(sample.payload.to_bytes(), self._parser):
            self._arrivals.setdefault(number, now)


def _send(
    out: socket.socket,
    address: tuple[str, int],
    systems: Sequence[int],
    rate: int,
    seconds: float,
    first: int,
) -> dict[int, float]:
    """Send, evenly spread; return when each number was sent."""
    times: dict[int, float] = {}
    count, begin = int(rate * seconds * len(systems)), time.perf_counter()
    for number in range(count):
        due = begin + number / (rate * len(systems))
        if (rest := due - time.perf_counter()) > 0.0005:
            time.sleep(rest)
        system = systems[number % len(systems)]
        if number // len(systems) % rate == 0:
            beat = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
            out.sendto(encode(beat, system=system, component=1, sequence=0), address)
        key = (first + number) % _NUMBERS
        message = common.Attitude(time_boot_ms=int(time.monotonic() * 1e3) % 2**32, rollspeed=key)
        data = encode(message, system=system, component=1, sequence=number // len(systems) % 256)
        times[key] = time.perf_counter()
        out.sendto(data, address)
    return times


@contextmanager
def router(
    zenoh: Any,  # noqa: ANN401 (it has no base class)
) -> Iterator[tuple[Any, str]]:
    """Run a Zenoh router; yield its session and its endpoint."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("listen/endpoints", json.dumps([endpoint]))
    with zenoh.open(config) as session:
        yield session, endpoint


@contextmanager
def bridge(name: str, port: int, endpoint: str, *options: str) -> Iterator[subprocess.Popen[str]]:
    """Run a bridge of the vehicles on a port; yield its process when it is ready."""
    command = [sys.executable, "-m", "mavstack", "bridge", name, f"udpin://127.0.0.1:{port}"]
    words = [*command, "--connect", endpoint, *options]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"PYTHONPYCACHEPREFIX": str(_BYTECODE)}
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        assert process.stdout is not None
        process.stdout.readline()
        yield process
    finally:
        process.kill()
        process.wait()


def _processor_time(process: subprocess.Popen[str]) -> float:
    values = Path(f"/proc/{process.pid}/stat").read_text("ascii").rsplit(")", 1)[1].split()
    return (int(values[11]) + int(values[12])) / os.sysconf("SC_CLK_TCK")


def free_port() -> int:
    """Return a port that no program uses."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
        return port
