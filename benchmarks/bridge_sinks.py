"""CPU of the bridges to Foxglove and MQTT for each message, with a client or a broker: rows of `bridges`.

Foxglove: ATTITUDE is parsed, converted, encoded and sent to a client; the peer is the program that people
write, pymavlink and a channel of JSON of the same library. MQTT: a group of telemetry as JSON to mosquitto.
"""

from __future__ import annotations

import shutil
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any, Final

from .measure import OURS, Ratio, Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

PEER: Final = "pymavlink and JSON"
#: Microseconds of a message to MQTT, the thread of the library included.
MAX_MESSAGE: Final = 100.0
_CLIENT: Final = """
import json, sys
from websockets.sync.client import connect
with connect(sys.argv[1], subprotocols=["foxglove.sdk.v1"], max_size=None) as socket:
    for frame in socket:
        fields = json.loads(frame) if isinstance(frame, str) else {}
        channels = fields.get("channels", []) if fields.get("op") == "advertise" else []
        if channels:
            numbers = [{"id": each["id"], "channelId": each["id"]} for each in channels]
            socket.send(json.dumps({"op": "subscribe", "subscriptions": numbers}))
            print("ready", flush=True)
"""


def foxglove_row(count: int, receiving: Callable[[int, Callable[[bytes, int], object]], float]) -> Row:
    """Measure an Imu publication to a client of Foxglove, beside JSON by the same library.

    Args:
        count: The number of messages.
        receiving: Measures the microseconds of messages that go to a receiver.
    """
    name = "Imu publication to Foxglove, CPU"
    try:
        import foxglove
        from pymavlink.dialects.v20 import common as pymavlink
    except ImportError:
        return Row(name, {OURS: "foxglove-sdk is not installed"}, ())
    from mavstack.bridges.foxglove.channels import ENCODING, ros_schema

    with _server(foxglove) as (context, subscribe):
        schema = ros_schema("sensor_msgs/msg/Imu")
        channel = foxglove.Channel("/imu", message_encoding=ENCODING, schema=schema, context=context)
        plain = foxglove.Channel("/json", message_encoding="json", context=context)
        with subscribe():
            pairs = [
                (receiving(count, lambda data, stamp: channel.log(data, log_time=stamp)), peer)
                for peer in (_of_peer(count, pymavlink, plain) for _ in range(3))
            ]
    figures = {OURS: f"{median(own for own, _ in pairs):.1f} µs"}
    figures[PEER] = f"{median(peer for _, peer in pairs):.1f} µs"
    return Row(name, figures, (Ratio(f"times {PEER}", tuple(peer / own for own, peer in pairs), 1.5),))


@contextmanager
def _server(foxglove: Any) -> Iterator[tuple[Any, Any]]:  # noqa: ANN401 (a module)
    context = foxglove.Context()
    server = foxglove.start_server(port=0, context=context)

    @contextmanager
    def subscribe() -> Iterator[None]:
        command = [sys.executable, "-c", _CLIENT, f"ws://127.0.0.1:{server.port}"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(0.5)
            yield
            process.kill()

    yield context, subscribe
    server.stop()


def _of_peer(count: int, pymavlink: Any, channel: Any) -> float:  # noqa: ANN401 (modules without types)
    from .bridges import BUNCH, PAUSE, packets

    parser, data = pymavlink.MAVLink(None), packets()
    start = time.process_time()
    for _ in range(count // BUNCH):
        for each in data:
            for message in parser.parse_buffer(each) or ():
                fields = message.to_dict()
                channel.log(fields)
        time.sleep(PAUSE)
    return (time.process_time() - start) / count * 1e6


def mqtt_row(count: int) -> Row:
    """Measure a group of telemetry to mosquitto."""
    name = "message to MQTT, CPU"
    program = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
    if program is None:
        return Row(name, {OURS: "mosquitto is not installed"}, ())
    own = median(_to_broker(program, count) for _ in range(3))
    limit = Ratio(f"of {MAX_MESSAGE:g} µs", (MAX_MESSAGE / own,), 1.0)
    return Row(name, {OURS: f"{own:.1f} µs"}, (limit,))


def _to_broker(program: str, count: int) -> float:
    import asyncio

    from mavstack.bridges.core.plain_json import json_bytes
    from mavstack.bridges.mqtt.broker import Broker, Session
    from mavstack.errors import LinkError

    from .bridges import BUNCH, PAUSE

    with socket.socket() as found, tempfile.TemporaryDirectory() as folder:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
        found.close()
        config = Path(folder) / "mosquitto.conf"
        config.write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
        group = {"time": 1.5, "latitude": 47.3977421, "longitude": 8.5455894, "altitude": 488.025}

        async def publish() -> float:
            for _ in range(50):
                session = Session(Broker("127.0.0.1", port), "bench/status")
                try:
                    await session.open()
                    break
                except LinkError:
                    await asyncio.sleep(0.1)
            start = time.process_time()
            for _ in range(count // BUNCH):
                for _ in range(BUNCH):
                    session.publish("bench/telemetry/position", json_bytes(group))
                await asyncio.sleep(PAUSE)
            used = time.process_time() - start
            await session.close()
            return used / count * 1e6

        with subprocess.Popen([program, "-c", str(config)], stderr=subprocess.DEVNULL) as broker:
            try:
                return asyncio.run(publish())
            finally:
                broker.terminate()
