"""Ten minutes of a bridge as a program: no reliable sample is lost, and its memory does not grow."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from mavstack import encode
from mavstack.bridges.core.types import codec_of
from mavstack.bridges.ros2.zenoh_keys import key_of
from mavstack.dialects import common
from tests.bridges.ros2.running import free_port, zenoh_client, zenoh_router

pytestmark = [pytest.mark.interop, pytest.mark.nightly]
#: Seconds; the environment of a busy machine sets fewer.
DURATION = float(os.environ.get("MAVSTACK_SOAK", "600"))
RATE = 50
VALUES, VALUE = "/mavros/debug_value/named_value_int", "mavros_msgs/msg/DebugValue"
IMU = key_of(0, "/mavros/imu/data", "sensor_msgs/msg/Imu")
#: Kilobytes by which the memory of the program may grow after its first minute.
MAX_GROWTH = 20_000
#: Seconds by which a value is late when all these programs were stopped. Sessions of Zenoh may end by that,
#: and the values of some seconds do not count.
STOP, RECONNECTION = 2.0, 10


def resident(process: subprocess.Popen[str]) -> int:
    lines = Path(f"/proc/{process.pid}/status").read_text("ascii").splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS")).split()[1])


class Vehicle:
    """A socket that sends numbered values and attitudes."""

    def __init__(self, port: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.address = ("127.0.0.1", port)
        self.sequence = 0
        self.values = 0
        #: The values that were the next ones when these programs were stopped.
        self.stops: list[int] = []

    def send(self, message: Any) -> None:
        data = encode(message, system=1, component=1, sequence=self.sequence % 256)
        self.socket.sendto(data, self.address)
        self.sequence += 1

    def send_for(self, seconds: float) -> None:
        begun = time.monotonic()
        for step in range(int(seconds * RATE)):
            rest = begun + step / RATE - time.monotonic()
            if rest < -STOP:
                begun -= rest
                self.stops.append(self.values)
            time.sleep(max(0.0, rest))
            if step % RATE == 0:
                self.send(common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4))
            self.send(common.Attitude(time_boot_ms=self.sequence))
            self.send(common.NamedValueInt(time_boot_ms=self.sequence, name="number", value=self.values))
            self.values += 1


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.timeout(2 * DURATION + 300)  # these programs may be stopped meanwhile
def test_no_reliable_sample_is_lost() -> None:
    got: list[int] = []
    codec, attitudes = codec_of(VALUE), [0]

    def receive(sample: Any) -> None:
        got.append(int(codec.decode_fields(sample.payload.to_bytes())["value_int"]))

    def count(_: Any) -> None:
        attitudes[0] += 1

    with zenoh_router() as router:
        session = zenoh_client(router)
        session.declare_subscriber(key_of(0, VALUES, VALUE), receive)
        session.declare_subscriber(IMU, count)
        vehicle = Vehicle(free_port())
        words = ["bridge", "ros2", f"udpin://127.0.0.1:{vehicle.address[1]}"]
        command = [sys.executable, "-m", "mavstack", *words, "--connect", f"tcp/127.0.0.1:{router}"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            process.stdout.readline()
            while not got:
                vehicle.send_for(1.0)
            vehicle.send_for(min(60.0, DURATION / 4))
            first, before = vehicle.values, resident(process)
            vehicle.send_for(DURATION)
            time.sleep(2)
            growth = resident(process) - before
            process.terminate()
        session.close()
        vehicle.socket.close()
    sent = range(first, vehicle.values)
    unclear = {value for stop in vehicle.stops for value in range(stop - RATE, stop + RECONNECTION * RATE)}
    missing = set(sent) - set(got) - unclear
    figures = {"sent": len(sent), "lost": len(missing), "attitudes": attitudes[0], "growth kB": growth}
    figures["stops"] = len(vehicle.stops)
    print(json.dumps(figures))
    assert not missing
    assert got == sorted(got)
    assert growth < MAX_GROWTH
