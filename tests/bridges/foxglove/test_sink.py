"""The Foxglove server: channels read by another implementation, services, parameters, and bad clients."""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
import sys
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.bridges.core.types import codec_of
from mavstack.errors import LinkError
from mavstack.security.roles import Role
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.foxglove.client import SUBPROTOCOL, FoxgloveClient, decoded
from tests.bridges.ros2.running import bridged, free_port, until

if TYPE_CHECKING:
    from pathlib import Path

pytest.importorskip("foxglove")
from mavstack.bridges.foxglove.parameters import FoxgloveParameters
from mavstack.bridges.foxglove.sink import FoxgloveSink, _Listener


def run(scenario: Any, role: Role = Role.ADMINISTER) -> None:
    """Run a scenario with a bridge of a simulated vehicle and a client."""
    websockets = pytest.importorskip("websockets")

    async def with_client() -> None:
        sink = FoxgloveSink("127.0.0.1", 0, control=role > Role.OBSERVE)
        async with bridged(simulator.url, sink, role=role) as (_, bridge):
            sink.parameters = FoxgloveParameters(bridge.vehicles, role, sink.publish_parameters)
            await until(lambda: 1 in bridge.vehicles)
            place = f"ws://127.0.0.1:{sink.port}"
            async with websockets.connect(place, subprotocols=[SUBPROTOCOL], max_size=None) as socket:
                client = FoxgloveClient(socket)
                await until(lambda: "/mavros/rtl" in client.services)
                await scenario(sink, bridge.vehicles[1], client)
                await client.close()

    with BackgroundSimulator() as simulator:
        asyncio.run(with_client())


@pytest.mark.interop
@pytest.mark.smoke
def test_another_implementation_reads_channels_and_calls_services() -> None:
    async def scenario(sink: FoxgloveSink, vehicle: Any, client: FoxgloveClient) -> None:
        topics = ("/mavros/imu/data", "/mavros/state", "/mavros/global_position/global", "/tf")
        panels = ("/mavros/foxglove/location", "/mavros/foxglove/transforms")
        for topic in (*topics, *panels):
            await client.subscribe(topic)
        await until(lambda: all(topic in client.messages for topic in (*topics, *panels)))
        imu = decoded(client.channels["/mavros/imu/data"], client.messages["/mavros/imu/data"][-1][1])
        assert imu.header.frame_id == "base_link"
        assert imu.linear_acceleration.z == pytest.approx(9.8, abs=0.6)
        state = decoded(client.channels["/mavros/state"], client.messages["/mavros/state"][-1][1])
        assert state.connected
        panel = client.channels["/mavros/foxglove/location"]
        assert (panel["schemaName"], panel["encoding"]) == ("foxglove.LocationFix", "protobuf")
        request = codec_of("mavros_msgs/srv/SetMode_Request").encode_fields({"custom_mode": "GUIDED"})
        await client.call("/mavros/set_mode", 7, request)
        await until(lambda: 7 in client.responses)
        answer = codec_of("mavros_msgs/srv/SetMode_Response").decode_fields(client.responses[7])
        assert answer == {"mode_sent": True}
        await until(lambda: vehicle.vehicle.mode == "GUIDED")
        await client.send(op="unsubscribe", subscriptionIds=[client.channels["/mavros/imu/data"]["id"]])
        await until(lambda: not vehicle.mapper.topics["imu/data"].active)

    run(scenario)


@pytest.mark.interop
def test_parameters_are_listed_and_written() -> None:
    async def scenario(sink: FoxgloveSink, vehicle: Any, client: FoxgloveClient) -> None:
        def values() -> dict[str, Any]:
            parts = [each["parameters"] for each in client.texts if each["op"] == "parameterValues"]
            return {each["name"]: each["value"] for part in parts for each in part}

        name = "/mavros/param/RTL_ALT"
        await client.send(op="subscribeParameterUpdates", parameterNames=[name])
        await client.send(op="getParameters", parameterNames=[], id="1")
        await until(lambda: name in values(), 40)
        await client.send(op="setParameters", parameters=[{"name": name, "value": 2000}], id="2")
        await until(lambda: values()[name] == 2000)
        assert (await vehicle.vehicle.params.get("RTL_ALT")).value == 2000
        await client.send(op="setParameters", parameters=[{"name": "/x", "value": 2000}], id="3")
        await until(
            lambda: any("there is no such vehicle" in each.get("message", "") for each in client.texts)
        )

    run(scenario)


@pytest.mark.interop
def test_setpoints_of_a_panel_and_garbage() -> None:
    async def scenario(sink: FoxgloveSink, vehicle: Any, client: FoxgloveClient) -> None:
        topic = "/mavros/setpoint_velocity/cmd_vel"
        channel = {"id": 5, "topic": topic, "schemaName": "geometry_msgs/TwistStamped"}
        await client.send(op="advertise", channels=[{**channel, "encoding": "json"}])
        twist = {"header": {"frame_id": "map"}, "twist": {"linear": {"x": 1.0}}}
        await client.publish(5, json.dumps(twist).encode())
        inlet = next(each for each in vehicle.inlets if each.name == topic)
        await until(lambda: inlet.accepted == 1)
        for data in (b"", b"{", b"[]", b'{"twist": 3}', b"\xff" * 50, b"[" * 50_000):
            await client.publish(5, data)
        await until(lambda: sink.refused == 6)
        await client.socket.send("{")
        await client.socket.send(b"\xff\xff")
        await client.send(op="advertise", channels=[{"id": "x"}])
        await client.publish(5, json.dumps(twist).encode())
        await until(lambda: inlet.accepted == 2)

    run(scenario)


@pytest.mark.interop
def test_an_observing_bridge_refuses() -> None:
    async def scenario(sink: FoxgloveSink, vehicle: Any, client: FoxgloveClient) -> None:
        capabilities = client.texts[0]["capabilities"]
        assert "clientPublish" not in capabilities
        await client.call("/mavros/arm", 1, codec_of("std_srvs/srv/Trigger_Request").encode_fields({}))
        await until(lambda: 1 in client.responses)
        answer = codec_of("std_srvs/srv/Trigger_Response").decode_fields(client.responses[1])
        assert answer["success"] is False
        assert "--allow-control" in answer["message"]
        await client.send(op="setParameters", parameters=[{"name": "/mavros/param/X", "value": 1}], id="1")
        await until(lambda: any("--allow-control" in each.get("message", "") for each in client.texts))

    run(scenario, Role.OBSERVE)


@pytest.mark.interop
def test_a_bridge_as_a_process(tmp_path: Path) -> None:
    with BackgroundSimulator() as simulator:
        words = [
            "bridge",
            "foxglove",
            simulator.url,
            "--port",
            "0",
            "--layout",
            str(tmp_path / "layout.json"),
        ]
        with subprocess.Popen(
            [sys.executable, "-m", "mavstack", *words], stdout=subprocess.PIPE, text=True
        ) as process:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line.startswith("Foxglove ws://127.0.0.1:")
            assert line.endswith("; read only; Ctrl-C to end\n")
            process.send_signal(signal.SIGTERM)
            assert process.wait(20) == 128 + signal.SIGTERM
    assert json.loads((tmp_path / "layout.json").read_text())["configById"]


def test_a_port_in_use_is_an_error_with_a_remedy() -> None:
    async def open_twice() -> None:
        port = free_port()
        first, second = FoxgloveSink("127.0.0.1", port), FoxgloveSink("127.0.0.1", port)
        await first.open()
        try:
            with pytest.raises(LinkError, match="--port names another port"):
                await second.open()
        finally:
            await first.close()
            await second.close()

    asyncio.run(open_twice())


@settings(deadline=None)
@given(st.text(max_size=20), st.sampled_from(["cdr", "json", ""]), st.binary(max_size=60))
def test_any_message_of_a_client_is_counted(topic: str, encoding: str, data: bytes) -> None:
    def refuse(payload: bytes) -> bool:
        codec_of("geometry_msgs/msg/TwistStamped").decode_fields(payload)
        return False

    sink = FoxgloveSink("127.0.0.1", 0)
    sink.add_inlet(
        SimpleNamespace(name=topic, type="geometry_msgs/msg/TwistStamped", receive=lambda _: False)
    )
    sink.receive(topic, encoding, data)
    sink.receive(f"{topic}/other", encoding, data)
    assert sink.refused == 2


@given(st.integers(0, 5), st.integers(0, 5), st.binary(max_size=9), st.lists(st.text(max_size=5), max_size=3))
def test_callbacks_before_and_after_the_server_runs_do_nothing(
    client: int, channel: int, data: bytes, names: list[str]
) -> None:
    listener = _Listener(FoxgloveSink("127.0.0.1", 0))
    peer, view = SimpleNamespace(id=client), SimpleNamespace(id=channel, topic="/x", encoding="cdr")
    listener.on_message_data(peer, channel, data)
    listener.on_client_advertise(peer, view)
    listener.on_message_data(peer, channel, data)
    listener.on_subscribe(peer, view)
    listener.on_unsubscribe(peer, view)
    listener.on_client_unadvertise(peer, channel)
    listener.on_client_unadvertise(peer, channel)
    assert listener.on_get_parameters(peer, names) == []
