"""Findings about a server of Foxglove: from its messages, and from a real one."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.bridges.core.types import message_text
from mavstack.bridges.foxglove.server_check import check_server, describe
from mavstack.errors import LinkError
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.ros2.running import bridged, free_port, until

IMU = "sensor_msgs/msg/Imu"
INFO = {"op": "serverInfo", "name": "Mavstack", "capabilities": ["services"]}


def channel(schema: str, name: str = IMU, encoding: str = "ros2msg") -> dict[str, object]:
    fields = {"topic": "/imu", "schemaName": name, "schemaEncoding": encoding, "schema": schema}
    return {"op": "advertise", "channels": [fields]}


def texts(*messages: dict[str, object]) -> list[tuple[bool, str]]:
    return [(each.ok, each.text) for each in describe("ws://h", messages)]


def test_a_server_with_our_definitions() -> None:
    found = texts(INFO, channel(message_text(IMU)), channel("any", "foxglove.Log", "protobuf"))
    assert found[0] == (True, "ws://h is Mavstack, with 2 channels and 0 services")
    assert all(ok for ok, _ in found)
    assert found[-1][1] == "clients only observe: the bridge has no --allow-control"


def test_problems() -> None:
    assert texts() == [(False, "ws://h does not present itself as a server of Foxglove")]
    assert (False, "there are no channels: has the bridge found a vehicle?") in texts(INFO)
    other, unknown = texts(INFO, channel("float64 x")), texts(INFO, channel("", "my_msgs/msg/Own"))
    assert (False, f"/imu has another definition of {IMU}: the bridge is of another version") in other
    assert (False, "/imu has the type my_msgs/msg/Own, which this version does not know") in unknown


@pytest.mark.parametrize("wrong", [None, 5, "/imu", {"topic": "/imu"}, [5, "/imu", None]])
def test_messages_of_another_shape(wrong: object) -> None:
    found = texts({**INFO, "capabilities": wrong}, {"channels": wrong, "services": wrong})
    assert found[0][1].startswith("ws://h is Mavstack, with 0 channels and ")
    assert found[-1][1] == "clients only observe: the bridge has no --allow-control"


@pytest.mark.interop
def test_a_running_bridge_and_none() -> None:
    pytest.importorskip("foxglove")
    pytest.importorskip("websockets")
    from mavstack.bridges.foxglove.sink import FoxgloveSink

    async def scenario(url: str) -> None:
        sink = FoxgloveSink("127.0.0.1", 0, control=True)
        async with bridged(url, sink) as (_, bridge):
            await until(lambda: not bridge._attaching)
            found = await check_server(f"ws://127.0.0.1:{sink.port}")
            assert all(each.ok for each in found), found
            assert found[-1].text == "clients may publish"
        with pytest.raises(LinkError, match="is `mav bridge foxglove` running"):
            await check_server(f"ws://127.0.0.1:{free_port()}")

    with BackgroundSimulator() as simulator:
        asyncio.run(scenario(simulator.url))
