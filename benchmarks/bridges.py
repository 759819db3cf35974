"""CPU of a bridge for each Imu publication, beside a bridge that builds messages of rclpy: the row `bridges`.

Ours parses ATTITUDE, converts it, encodes it and puts it into Zenoh, through a router to a subscriber. The
peer is the bridge that people write: pymavlink, and rclpy message objects on Fast DDS, with a subscriber. It
needs the ROS installation of `tools/ros_installation.py`. Both send bunches of twenty, at up to 2,000 a
second, and count the processor time of their process with all its threads.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

from mavstack import Parser, encode
from mavstack.bridges.core.mapper import Mapper
from mavstack.bridges.core.table import PUBLICATIONS
from mavstack.bridges.core.topic import Topic
from mavstack.bridges.core.view import VehicleView
from mavstack.dialects import Dialect, common
from tools import ros_installation

from .bridge_sinks import foxglove_row, mqtt_row
from .measure import OURS, Ratio, Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .rows import Bench

PEER: Final = "pymavlink and rclpy messages"
NAME: Final = "imu/data"
BUNCH: Final = 20
PAUSE: Final = 0.01
#: Bytes of a sample of sensor_msgs/Imu.
SAMPLE_SIZE: Final = 324
#: Microseconds: of a publication, and of a message whose row has no subscriber.
MAX_PUBLICATION, MAX_IDLE = 15.0, 0.3
_PEER: Final = """
import json, math, sys, threading, time
import rclpy
from pymavlink.dialects.v20 import common
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Imu
from mavstack import encode
from mavstack.dialects import common as ours
count, bunch, pause = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
rclpy.init()
node = rclpy.create_node("bench")
if len(sys.argv) > 4:
    node.create_subscription(Imu, "/bench", lambda message: None, qos_profile_sensor_data, raw=True)
    rclpy.spin(node)
publisher = node.create_publisher(Imu, "/bench", qos_profile_sensor_data)
messages = [ours.Attitude(time_boot_ms=i, roll=0.1) for i in range(bunch)]
data = [encode(each, system=1, component=1, sequence=i) for i, each in enumerate(messages)]
parser = common.MAVLink(None)
while not publisher.get_subscription_count():
    time.sleep(0.05)
for _ in range(3):
    start = time.process_time()
    for _ in range(count // bunch):
        for each in data:
            for a in parser.parse_buffer(each) or ():
                m = Imu()
                m.header.stamp = node.get_clock().now().to_msg()
                m.header.frame_id = "base_link"
                half = (a.roll / 2, a.pitch / 2, a.yaw / 2)
                (cr, cp, cy), (sr, sp, sy) = map(math.cos, half), map(math.sin, half)
                m.orientation.w = cr * cp * cy + sr * sp * sy
                m.orientation.x = sr * cp * cy - cr * sp * sy
                m.orientation.y = cr * sp * cy + sr * cp * sy
                m.orientation.z = cr * cp * sy - sr * sp * cy
                m.angular_velocity.x = a.rollspeed
                m.angular_velocity.y = -a.pitchspeed
                m.angular_velocity.z = -a.yawspeed
                publisher.publish(m)
        time.sleep(pause)
    print(json.dumps((time.process_time() - start) / count * 1e6), flush=True)
"""
_SUBSCRIBER: Final = """
import json, sys, time, zenoh
config = zenoh.Config()
config.insert_json5("mode", '"router"')
config.insert_json5("scouting/multicast/enabled", "false")
config.insert_json5("listen/endpoints", json.dumps([sys.argv[1]]))
with zenoh.open(config) as session:
    subscriber = session.declare_subscriber("bench/imu", lambda sample: None)
    print("ready", flush=True)
    time.sleep(600)
"""


def rows(bench: Bench) -> Iterator[Row]:
    """Measure the processor time of a publication, and of a message without a subscriber."""
    count = bench.amounts.slow // 20 * 4
    parsing, idle = _parsing(count), _receiving(count, None)
    figure = f"{max(idle - parsing, 0.0):.2f} µs"
    yield Row("message whose row has no subscriber", {OURS: figure}, (_under(idle - parsing, MAX_IDLE),))
    yield foxglove_row(count, _receiving)
    yield mqtt_row(count)
    try:
        import zenoh
    except ImportError:
        yield Row("Imu publication, CPU", {OURS: "zenoh is not installed"}, ())
        return
    with _zenoh_subscriber(zenoh) as (put, flush):
        pairs_of_puts = [(_receiving(count, put, flush), _putting(count, put, flush)) for _ in range(3)]
    ours, bare = zip(*pairs_of_puts, strict=True)
    theirs = _of_peer(count) if ros_installation.is_complete() else []
    figures = {OURS: f"{statistics.median(ours):.1f} µs, {statistics.median(bare):.1f} of them by Zenoh"}
    ratios = [_under(statistics.median(ours), MAX_PUBLICATION)]
    if theirs:
        figures[PEER] = f"{statistics.median(theirs):.1f} µs"
        pairs = tuple(peer / own for peer, own in zip(theirs, ours, strict=True))
        ratios.append(Ratio(f"times {PEER}", pairs, 2.0))
    yield Row("Imu publication, CPU", figures, tuple(ratios))


def _under(value: float, limit: float) -> Ratio:
    return Ratio(f"of {limit:g} µs", (limit / max(value, 0.01),), 1.0)


def packets() -> list[bytes]:
    """Return a bunch of packets."""
    messages = (common.Attitude(time_boot_ms=number, roll=0.1) for number in range(BUNCH))
    return [encode(each, system=1, component=1, sequence=number) for number, each in enumerate(messages)]


def _parsing(count: int) -> float:
    parser, data = Parser(Dialect.load("all")), packets()
    start = time.process_time()
    for _ in range(count // BUNCH):
        for each in data:
            for packet in parser.feed(each):
                _ = packet.message_id
    return (time.process_time() - start) / count * 1e6


def _receiving(
    count: int, put: Callable[[bytes, int], object] | None, flush: Callable[[], None] = lambda: None
) -> float:
    """Return the microseconds of a message; without a receiver it has no listener, as in the bridge."""
    imu = common.HighresImu(zacc=-9.8)
    view = VehicleView(lambda kind: imu if kind is common.HighresImu else None)  # type: ignore[arg-type, return-value]
    topic = Topic(next(row for row in PUBLICATIONS if row.name == NAME), f"/{NAME}", "base_link")
    if put is not None:
        topic.add_receiver(put)
    mapper = Mapper(view, [topic])
    listeners: dict[int, Any] = {}
    if topics := mapper.topics_of(common.Attitude):
        listeners[30] = lambda packet: mapper.receive(packet.message, time.time_ns(), topics)
    parser, data = Parser(Dialect.load("all")), packets()
    start = time.process_time()
    for _ in range(count // BUNCH):
        for each in data:
            for packet in parser.feed(each):
                if (listener := listeners.get(packet.message_id)) is not None:
                    listener(packet)
        if put is not None:
            flush()
            time.sleep(PAUSE)
    return (time.process_time() - start) / count * 1e6


def _putting(count: int, put: Callable[[bytes, int], object], flush: Callable[[], None]) -> float:
    """Return the microseconds of a sample whose bytes are ready: the part of the library."""
    payload = bytes(SAMPLE_SIZE)
    start = time.process_time()
    for _ in range(count // BUNCH):
        for _ in range(BUNCH):
            put(payload, 0)
        flush()
        time.sleep(PAUSE)
    return (time.process_time() - start) / count * 1e6


@contextmanager
def _zenoh_subscriber(
    zenoh: Any,  # noqa: ANN401 (it has no base class)
) -> Iterator[tuple[Callable[[bytes, int], object], Callable[[], None]]]:
    """Run a router with a subscriber; yield a receiver that puts as the bridge does, and its flush."""
    from mavstack.bridges.ros2.put_queue import PutQueue
    from mavstack.bridges.ros2.zenoh_keys import attachment_of

    endpoint = "tcp/127.0.0.1:17997"
    process = subprocess.Popen(
        [sys.executable, "-c", _SUBSCRIBER, endpoint], stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        process.stdout.readline()
        config = zenoh.Config()
        config.insert_json5("mode", '"client"')
        config.insert_json5("connect/endpoints", json.dumps([endpoint]))
        with zenoh.open(config) as session:
            drop, remote = zenoh.CongestionControl.DROP, zenoh.Locality.REMOTE
            publisher = session.declare_publisher(
                "bench/imu", congestion_control=drop, allowed_destination=remote
            )
            gid = bytes(16)
            turn: list[Callable[[], None]] = []
            queue = PutQueue(turn.append)

            def put(payload: bytes, attachment: bytes) -> None:
                publisher.put(payload, attachment=attachment)

            def end_of_turn() -> None:
                while turn:
                    turn.pop()()

            yield lambda payload, stamp: queue.add(put, payload, attachment_of(1, stamp, gid)), end_of_turn
    finally:
        process.kill()
        process.wait()


def _of_peer(count: int) -> list[float]:
    command = [str(ros_installation.FOLDER / "bin" / "python"), "-c", _PEER]
    words = [str(count), str(BUNCH), str(PAUSE)]
    environment = ros_installation.environment() | {"ROS_DOMAIN_ID": "97"}
    subscriber = subprocess.Popen([*command, *words, "subscribe"], env=environment)
    try:
        done = subprocess.run(
            [*command, *words], env=environment, capture_output=True, text=True, timeout=300, check=True
        )
    finally:
        subscriber.kill()
        subscriber.wait()
    return [json.loads(line) for line in done.stdout.splitlines()]
