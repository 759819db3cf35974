"""Requests and setpoints through whole bridge programs, and their start: the row `bridge-requests`.

The vehicle is a socket of this process, which sends ATTITUDE, acknowledges commands after a fixed time, and
notes when setpoints arrive. Clients are sessions of Zenoh in this process too, behind its router.
"""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import threading
import time
from statistics import median, quantiles
from typing import TYPE_CHECKING, Any, Final

from mavstack import Parser, encode
from mavstack.bridges.core.types import codec_of
from mavstack.bridges.ros2.zenoh_keys import attachment_of, key_of
from mavstack.dialects import Dialect, common

from .bridge_programs import bridge, free_port, router
from .measure import OURS, Ratio, Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .rows import Bench

#: Milliseconds that a service may take beyond the vehicle's answer, and of the age of 95 % of the setpoints.
MAX_SERVICE, MAX_AGE = 2.0, 20.0
#: Seconds from the start of a program to its first sample.
MAX_START, STARTS = 1.0, 3
#: Seconds of the vehicle's answer, and between two setpoints.
_ANSWER_TIME: Final = 0.005
_SETPOINT_INTERVAL: Final = 0.02
_READY_TIME: Final = 4.0
_QUERYABLE: Final = """
import json, sys, time, zenoh
config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", json.dumps([sys.argv[1]]))
with zenoh.open(config) as session:
    def answer(query):
        with query:
            query.reply("bench/echo", query.payload)
    queryable = session.declare_queryable("bench/echo", zenoh.handlers.Callback(answer, indirect=False))
    print("ready", flush=True)
    time.sleep(600)
"""
_SERVICE: Final = "mavros_msgs/srv/CommandLong"
_SETPOINT: Final = "geometry_msgs/msg/PoseStamped"
_REQUEST: Final = {
    "broadcast": False,
    "command": int(common.MavCmd.DO_SET_SERVO),
    "confirmation": 0,
    **{f"param{number}": float(number) for number in range(1, 8)},
}


class _Vehicle:
    """A vehicle on a socket."""

    def __init__(self, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(("127.0.0.1", port))
        self._ended = threading.Event()
        #: The seconds of each answer, and the times of the setpoints by their numbers.
        self.answers: list[float] = []
        self.setpoints: dict[int, float] = {}
        self._threads = [threading.Thread(target=work, daemon=True) for work in (self._send, self._receive)]
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """End the threads."""
        self._ended.set()
        self._socket.shutdown(socket.SHUT_RDWR)
        for thread in self._threads:
            thread.join()
        self._socket.close()

    def _write(self, message: Any, sequence: int = 0) -> None:  # noqa: ANN401 (any message)
        try:
            self._socket.send(encode(message, system=1, component=1, sequence=sequence))
        except OSError:  # the bridge does not listen yet
            return

    def _send(self) -> None:
        beat = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
        number = 0
        while not self._ended.wait(0.02):
            if number % 10 == 0:
                self._write(beat, number % 256)
            number += 1
            self._write(common.Attitude(time_boot_ms=20 * number), number % 256)

    def _receive(self) -> None:
        parser = Parser(Dialect.load("all"))
        while not self._ended.is_set():
            try:
                data = self._socket.recv(4096)
            except OSError:
                continue
            now = time.perf_counter()
            for packet in parser.feed(data):
                match packet.message:
                    case common.CommandLong(command=command):
                        time.sleep(_ANSWER_TIME)
                        self.answers.append(time.perf_counter() - now)
                        self._write(common.CommandAck(command=command))
                    case common.SetPositionTargetLocalNed(x=x, y=y):
                        self.setpoints.setdefault(round(x + y), now)


def rows(bench: Bench) -> Iterator[Row]:
    """Measure services, setpoints and the start of `mav bridge zenoh` and `mav bridge ros2`."""
    try:
        import zenoh
    except ImportError:
        yield Row("bridge requests", {OURS: "zenoh is not installed"}, ())
        return
    count = max(200, bench.amounts.slow // 200)
    port = free_port()
    vehicle = _Vehicle(port)
    try:
        with router(zenoh) as (session, endpoint):
            yield _start_row("zenoh", "mavstack/*/frame/out", session, port, endpoint)
            yield _start_row("ros2", "**/imu/data/**", session, port, endpoint)
            bare = _of_queryable(session, endpoint, count)
            with bridge("zenoh", port, endpoint, "--allow-control"):
                yield _service_row("zenoh", vehicle, _fleet_call(session), count, bare)
            with bridge("ros2", port, endpoint, "--allow-control"):
                yield _service_row("ros2", vehicle, _ros2_call(session), count, bare)
                yield _setpoint_row(session, vehicle, count)
    finally:
        vehicle.close()


def _start_row(name: str, key: str, session: Any, port: int, endpoint: str) -> Row:  # noqa: ANN401 (of Zenoh)
    times: list[float] = []
    for _ in range(1 + STARTS):  # the first one may write the bytecode
        arrived = threading.Event()
        subscriber = session.declare_subscriber(key, lambda sample, arrived=arrived: arrived.set())
        begun = time.perf_counter()
        with bridge(name, port, endpoint):
            arrived.wait(20)
            times.append(time.perf_counter() - begun)
        subscriber.undeclare()
    times = times[1:]
    limits = tuple(MAX_START / each for each in times)
    figures = {OURS: f"{median(times):.2f} s"}
    return Row(f"mav bridge {name}: first sample after the start", figures, (_ratio(MAX_START, "s", limits),))


def _of_queryable(session: Any, endpoint: str, count: int) -> list[float]:  # noqa: ANN401 (of Zenoh)
    """Return the milliseconds of requests to a process that echoes them: the part of the library."""
    command = [sys.executable, "-c", _QUERYABLE, endpoint]
    times = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()
        for _ in range(count):
            time.sleep(_ANSWER_TIME)
            begun = time.perf_counter()
            (_,) = session.get("bench/echo", payload=bytes(64), timeout=5.0)
            times.append(1e3 * (time.perf_counter() - begun))
        process.kill()
    return times


def _service_row(
    name: str, vehicle: _Vehicle, call: Callable[[], bool], count: int, bare: list[float]
) -> Row:
    time.sleep(_READY_TIME)
    vehicle.answers.clear()
    added = []
    for _ in range(count):
        begun = time.perf_counter()
        accepted = call()
        ended = time.perf_counter()
        assert accepted
        added.append(1e3 * (ended - begun - vehicle.answers[-1]))
    tail = quantiles(added, n=100)[98]
    figures = {OURS: f"{median(added):.2f}, {tail:.2f} ms; Zenoh alone {median(bare):.2f} ms"}
    work = f"mav bridge {name}: service beyond the vehicle's answer: median, 99th percentile"
    return Row(work, figures, (_ratio(MAX_SERVICE, "ms", (MAX_SERVICE / median(added),)),))


def _fleet_call(session: Any) -> Callable[[], bool]:  # noqa: ANN401 (of Zenoh)
    payload = json.dumps(_REQUEST).encode()

    def call() -> bool:
        (reply,) = session.get("mavstack/sys1/command/cmd/command", payload=payload, timeout=5.0)
        return bool(json.loads(reply.ok.payload.to_bytes())["ok"])

    return call


def _ros2_call(session: Any) -> Callable[[], bool]:  # noqa: ANN401 (of Zenoh)
    key = key_of(0, "/mavros/cmd/command", _SERVICE)
    request, response = codec_of(f"{_SERVICE}_Request"), codec_of(f"{_SERVICE}_Response")
    payload, attachment = request.encode_fields(_REQUEST), attachment_of(1, time.time_ns(), bytes(16))

    def call() -> bool:
        (reply,) = session.get(key, payload=payload, attachment=attachment, timeout=5.0)
        return bool(response.decode_fields(reply.ok.payload.to_bytes())["success"])

    return call


def _setpoint_row(session: Any, vehicle: _Vehicle, count: int) -> Row:  # noqa: ANN401 (of Zenoh)
    publisher = session.declare_publisher(key_of(0, "/mavros/setpoint_position/local", _SETPOINT))
    codec = codec_of(_SETPOINT)
    sent: dict[int, float] = {}
    time.sleep(1.0)
    for number in range(1, count + 1):
        stamp = time.time_ns()
        header = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": "map"}
        pose = {"position": {"x": float(number)}, "orientation": {"w": 1.0}}
        payload = codec.encode_fields({"header": header, "pose": pose})
        sent[number] = time.perf_counter()
        publisher.put(payload, attachment=attachment_of(number, stamp, bytes(16)))
        time.sleep(_SETPOINT_INTERVAL)
    publisher.undeclare()
    ages = [
        1e3 * (vehicle.setpoints[number] - at) for number, at in sent.items() if number in vehicle.setpoints
    ]
    tail = quantiles(ages, n=20)[18]
    figures = {OURS: f"{median(ages):.2f}, {tail:.2f} ms, {count - len(ages)} of {count} lost"}
    work = "mav bridge ros2: age of a setpoint at the vehicle: median, 95th percentile"
    return Row(work, figures, (_ratio(MAX_AGE, "ms", (MAX_AGE / tail,)),))


def _ratio(limit: float, unit: str, values: tuple[float, ...]) -> Ratio:
    return Ratio(f"of {limit:g} {unit}", values, 1.0)
