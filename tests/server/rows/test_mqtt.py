"""Sources of values from an MQTT broker (mosquitto)."""

from __future__ import annotations

import asyncio
import struct
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.mqtt.broker import Arrived, Broker, Session
from mavstack.errors import LinkError, LinkURLError
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.rows.hub import RowHub
from mavstack.server.rows.mqtt import is_topic_filter
from mavstack.server.rows.source import RowReader
from mavstack.server.rows.urls import parse_row_url
from mavstack.server.station import Station
from tests.bridges.mqtt.test_broker import Client, broker, needs_mosquitto
from tests.bridges.ros2.running import free_port
from tests.server.asgi import ApiClient
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Sequence

DECODER = {"name": "bench", "messages": [{"name": "BENCH", "fields": [{"name": "volts", "type": "float32"}]}]}


@pytest.mark.parametrize("text", ["a", "a/b", "a/+/c", "#", "a/#", "+"])
def test_filters_of_topics(text: str) -> None:
    assert is_topic_filter(text)


@pytest.mark.parametrize("text", ["", "a#", "a/#/b", "a+/b", "a\0", "x" * 1025])
def test_malformed_filters_of_topics(text: str) -> None:
    assert not is_topic_filter(text)


@pytest.mark.parametrize(
    ("query", "reason"),
    [("", "must name topics"), ("?topic=a%23", "must name topics"), ("?topic=a&x=1", "no option")],
)
def test_urls_without_topics_are_refused(query: str, reason: str) -> None:
    pytest.importorskip("paho.mqtt")
    with pytest.raises(LinkURLError, match=reason):
        RowReader(parse_row_url(f"frames+mqtt://127.0.0.1{query}"), "bench", RowHub())


class ScriptedSession:
    """The session with a broker that ends and comes back, and sends two messages."""

    def __init__(self, _broker: Broker, *, subscriptions: Sequence[str], take: Any, **calls: Any) -> None:
        self.subscriptions, self.take = subscriptions, take
        self.connected, self.disconnected = calls["connected"], calls["disconnected"]

    async def open(self) -> None:
        for payload in (b"3", b"4"):
            self.disconnected("the keep-alive time is over")
            self.connected()
            self.take(Arrived(self.subscriptions[0], payload))
            self.take(Arrived(self.subscriptions[0], discarded=2_000_000))

    async def close(self) -> None:
        """Do nothing."""


async def test_each_message_is_a_line_after_a_reconnection_too(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("mavstack.server.rows.mqtt.Session", ScriptedSession)
    hub = RowHub()
    reader = RowReader(parse_row_url("csv+mqtt://127.0.0.1?topic=a/+&template=v:m"), "bench", hub)
    await reader.open()
    await wait_until(lambda: reader.received == 2)
    assert "a/+: a message with 2000000 bytes is discarded" in caplog.messages
    assert len(reader.link.channels) == 1
    reader.link._session.disconnected("the keep-alive time is over")
    assert not reader.link.channels
    latest = hub.latest["bench", "ROW"]
    assert (latest.count, latest.value["fields"]) == (2, {"v": 4})
    assert parse_row_url("frames+mqtt://127.0.0.1?topic=a/+/b").link.options["topic"] == "a/+/b"
    await reader.close()


async def test_no_broker_is_an_error() -> None:
    pytest.importorskip("paho.mqtt")
    url = parse_row_url(f"frames+mqtt://127.0.0.1:{free_port()}?topic=a&password=hidden")
    assert "hidden" not in url.text
    with pytest.raises(LinkError, match="connecting to the MQTT broker"):
        await RowReader(url, "bench", RowHub()).open()


@pytest.mark.interop
@needs_mosquitto
async def test_messages_are_frames_and_lines(tmp_path: Any) -> None:
    async with Station(network_only=True) as station:
        api = ApiClient(make_app(station, Access(), static=None))

        async def states() -> list[Any]:
            return [(each["state"], each["rows"]["refused"]) for each in (await api.get("/api/sources")).json]

        with broker(tmp_path) as port:
            await asyncio.to_thread(lambda: Client(port).close())  # it waits until the broker accepts
            frames = f"frames+mqtt://127.0.0.1:{port}?topic=bench/+&name=bench"
            assert (await api.post("/api/sources", {"url": frames, "decoder": DECODER})).status == 201
            lines = f"csv+mqtt://127.0.0.1:{port}?topic=text&name=text&template=a:m"
            assert (await api.post("/api/sources", {"url": lines})).status == 201
            sender = Session(Broker("127.0.0.1", port))
            await sender.open()
            latest = station.sources.rows.latest

            def is_received() -> bool:
                sender.publish("bench/one", struct.pack("<f", 11.5))
                sender.publish("other/one", b"\0\0\0\0")
                sender.publish("text", b"3")
                return {("bench", "BENCH"), ("text", "ROW")} <= latest.keys()

            await wait_until(is_received)
            await sender.close()
            assert latest["bench", "BENCH"].value["fields"] == {"volts": 11.5}
            assert latest["text", "ROW"].value["fields"] == {"a": 3}
            assert await states() == [("connected", 0), ("connected", 0)]
        await wait_until(lambda: all(each.state == "waiting" for each in station.sources.list()))
        assert await states() == [("waiting", 0), ("waiting", 0)]
