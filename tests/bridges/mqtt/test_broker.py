"""URLs of brokers, and sessions with mosquitto: last will, retained state, requests of MQTT 5, TLS, drops."""

from __future__ import annotations

import asyncio
import json
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.plain_json import MAX_REQUEST
from mavstack.bridges.core.sink import MAX_ITEMS
from mavstack.bridges.mqtt.broker import MAX_PACKET, Arrived, Broker, Session
from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.ros2.running import free_port, until

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MOSQUITTO = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
needs_mosquitto = pytest.mark.skipif(MOSQUITTO is None, reason="mosquitto is not installed")


def test_urls() -> None:
    assert Broker.parse("mqtt://127.0.0.1") == Broker("127.0.0.1", 1883)
    assert Broker.parse("mqtts://a%40b:se%2Fcret@[::1]:99") == Broker("::1", 99, True, "a@b", "se/cret")
    assert str(Broker.parse("mqtts://user:secret@host")) == "mqtts://host:8883"
    assert "secret" not in repr(Broker.parse("mqtt://user:secret@host"))


@pytest.mark.parametrize(
    "url",
    [
        "",
        "host",
        "tcp://host",
        "mqtt://",
        "mqtt://h:99999",
        "mqtt://h/path",
        "mqtt://u:hidden@",
        "mqtt://[::1",
    ],
)
def test_a_wrong_url_is_refused_without_its_password(url: str) -> None:
    with pytest.raises(InvalidArgumentError, match="a broker must be") as caught:
        Broker.parse(url)
    assert "hidden" not in str(caught.value)


def test_no_broker_is_an_error_with_a_remedy() -> None:
    pytest.importorskip("paho.mqtt")
    session = Session(Broker("127.0.0.1", free_port()), "x/status")
    with pytest.raises(LinkError, match=r"mqtt://127\.0\.0\.1.* failed: nothing accepts connections there"):
        asyncio.run(session.open())


def test_messages_without_a_connection_are_dropped_and_counted() -> None:
    pytest.importorskip("paho.mqtt")
    session = Session(Broker("127.0.0.1", free_port()), "x/status")
    assert not session.publish("x/telemetry", b"1")
    assert not session.publish("x/+", b"1")
    for _ in range(MAX_ITEMS):
        assert session.publish("x/state", b"1", qos=1)
    assert not session.publish("x/state", b"1", qos=1)
    assert session.dropped == 3


@contextmanager
def broker(folder: Path, port: int = 0) -> Iterator[int]:
    """A running mosquitto."""
    port = port or free_port()
    config = folder / "mosquitto.conf"
    config.write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
    with subprocess.Popen([str(MOSQUITTO), "-c", config], stderr=subprocess.DEVNULL) as process:
        try:
            yield port
        finally:
            process.terminate()


class Client:
    """A client that subscribes to everything."""

    def __init__(self, port: int) -> None:
        from paho.mqtt import client, enums

        self.messages: list[Any] = []
        self.client = client.Client(enums.CallbackAPIVersion.VERSION2, protocol=client.MQTTv5)
        self.client.on_connect = lambda *arguments: arguments[0].subscribe("#", qos=1)
        self.client.on_message = lambda *arguments: self.messages.append(arguments[-1])
        for _ in range(100):
            try:
                self.client.connect("127.0.0.1", port)
                break
            except OSError:
                time.sleep(0.05)
        self.client.loop_start()

    def wait_for(self, topic: str, content: bytes = b"", timeout: float = 20) -> Any:
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            for message in list(self.messages):
                if message.topic == topic and content in message.payload:
                    return message
            time.sleep(0.02)
        raise AssertionError(f"no {topic}: {sorted({each.topic for each in self.messages})}")

    def request(self, topic: str, payload: dict[str, Any], correlation: bytes) -> dict[str, Any]:
        from paho.mqtt.properties import PacketTypes, Properties

        properties = Properties(PacketTypes.PUBLISH)
        properties.ResponseTopic, properties.CorrelationData = "client/answers", correlation
        self.client.publish(topic, json.dumps(payload), properties=properties)
        end = time.monotonic() + 20
        while time.monotonic() < end:
            for message in list(self.messages):
                if getattr(message.properties, "CorrelationData", b"") == correlation and (
                    message.topic == "client/answers"
                ):
                    answer: dict[str, Any] = json.loads(message.payload)
                    return answer
            time.sleep(0.02)
        raise AssertionError("no answer")

    def close(self) -> None:
        self.client.disconnect()
        self.client.loop_stop()


@pytest.mark.interop
@pytest.mark.smoke
@needs_mosquitto
def test_a_bridge_as_a_process_with_mosquitto(tmp_path: Path) -> None:
    pytest.importorskip("paho.mqtt")
    with BackgroundSimulator() as simulator, broker(tmp_path) as port:
        client = Client(port)
        words = ["bridge", "mqtt", simulator.url, "--broker", f"mqtt://127.0.0.1:{port}", "--home-assistant"]
        command = [sys.executable, "-m", "mavstack", *words, "--allow-control", "--role", "operate"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line == (
                f"MQTT mqtt://127.0.0.1:{port}, topics below mavstack/; control allowed; Ctrl-C to end\n"
            )
            client.wait_for("mavstack/uav1/status", b"online")
            position = json.loads(client.wait_for("mavstack/uav1/telemetry/position").payload)
            assert 40 < position["latitude"] < 50
            client.wait_for("homeassistant/device/mavstack_uav1/config")
            mode = client.request("mavstack/uav1/cmd/mode", {"mode": "GUIDED"}, b"\0\xff1")
            assert mode == {"command": "mode", "ok": True}
            client.wait_for("mavstack/uav1/state", b'"mode":"GUIDED"')
            refused = client.request("mavstack/uav1/cmd/reboot", {}, b"2")
            assert refused["reason"] == "reboot refused: it needs the role administer, the bridge has operate"
            late = Client(port)
            assert late.wait_for("mavstack/uav1/state").retain
            late.close()
            process.send_signal(signal.SIGTERM)
            assert process.wait(20) == 128 + signal.SIGTERM
            client.wait_for("mavstack/uav1/status", b"offline")
        client.close()


@pytest.mark.interop
@needs_mosquitto
def test_a_bridge_that_is_killed_leaves_its_last_will(tmp_path: Path) -> None:
    pytest.importorskip("paho.mqtt")
    with BackgroundSimulator() as simulator, broker(tmp_path) as port:
        client = Client(port)
        words = ["bridge", "mqtt", simulator.url, "--broker", f"mqtt://127.0.0.1:{port}"]
        with subprocess.Popen([sys.executable, "-m", "mavstack", *words], stdout=subprocess.PIPE) as process:
            client.wait_for("mavstack/uav1/status", b"online")
            process.kill()
        client.wait_for("mavstack/uav1/status", b"offline")
        client.close()


@pytest.mark.interop
@needs_mosquitto
def test_a_session_connects_again_after_the_broker_was_away(tmp_path: Path) -> None:
    pytest.importorskip("paho.mqtt")

    async def run() -> None:
        greeted: list[int] = []
        with broker(tmp_path) as port:
            Client(port).close()  # it waits until the broker accepts
            session = Session(Broker("127.0.0.1", port), "x/status", connected=lambda: greeted.append(1))
            await session.open()
        assert greeted == [1]
        with broker(tmp_path, port):
            await until(lambda: len(greeted) > 1)
            await session.close()

    asyncio.run(run())


@pytest.mark.interop
@needs_mosquitto
def test_the_broker_sends_no_message_that_is_larger_than_the_limit(tmp_path: Path) -> None:
    pytest.importorskip("paho.mqtt")
    sizes = (MAX_REQUEST, MAX_REQUEST + 1, MAX_PACKET, 3)

    async def run() -> None:
        found: list[Arrived] = []
        with broker(tmp_path) as port:
            client = Client(port)
            session = Session(Broker("127.0.0.1", port), subscriptions=("in",), take=found.append)
            await session.open()
            # The subscription may take a moment longer than the connection.
            await until(lambda: found or not client.client.publish("in", b"first"))
            found.clear()
            for size in sizes:
                client.client.publish("in", bytes(size))
            await until(lambda: found and len(found[-1].payload) == sizes[-1])
            client.close()
            await session.close()
        assert [(len(each.payload), each.discarded) for each in found if each.payload != b"first"] == [
            (MAX_REQUEST, 0),
            (0, MAX_REQUEST + 1),
            (3, 0),
        ]

    asyncio.run(run())
