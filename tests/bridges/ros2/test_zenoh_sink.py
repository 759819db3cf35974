"""ROS 2 over Zenoh, with an independent implementation of rmw_zenoh's wire as the client."""

from __future__ import annotations

import asyncio
import time
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.types import codec_of, message_text, type_hash
from mavstack.bridges.core.types.definitions import definition_text
from mavstack.bridges.ros2.zenoh_keys import attachment_of, key_of, parse_attachment
from mavstack.bridges.ros2.zenoh_sink import ZenohSink
from mavstack.errors import LinkError
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.ros2.running import (
    bridged,
    free_port,
    until,
    zenoh_client,
    zenoh_ros2_sdk,
    zenoh_router,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [pytest.mark.interop, pytest.mark.filterwarnings("ignore")]
STATE = "mavros_msgs/msg/State"
IMU = "sensor_msgs/msg/Imu"


@pytest.fixture
def router() -> Iterator[int]:
    with zenoh_router() as port:
        yield port


def run(router: int, scenario: Any, **options: Any) -> None:
    """Run a scenario with a bridge of a simulated copter, which flies in the third of the time."""

    async def bridge() -> None:
        sink = ZenohSink(0, [f"tcp/127.0.0.1:{router}"])
        async with bridged(simulator.url, sink) as (connection, opened):
            await scenario(connection, opened, sink)

    with BackgroundSimulator(**options) as simulator:
        asyncio.run(bridge())


@pytest.mark.smoke
def test_an_independent_client_reads_topics_and_calls_services(router: int) -> None:
    sdk = zenoh_ros2_sdk()

    async def scenario(connection: Any, bridge: Any, sink: ZenohSink) -> None:
        loop = asyncio.get_running_loop()
        got: list[Any] = []
        place = {"router_ip": "127.0.0.1", "router_port": router}
        subscribe = partial(
            sdk.ROS2Subscriber, msg_definition=message_text(IMU), type_hash=type_hash(IMU), **place
        )
        subscriber = await loop.run_in_executor(
            None, partial(subscribe, topic="/mavros/imu/data", msg_type=IMU, callback=got.append)
        )
        await until(lambda: len(got) > 5)
        assert got[-1].header.frame_id == "base_link"
        assert got[-1].linear_acceleration.z == pytest.approx(9.8, abs=0.6)
        request, response = definition_text("mavros_msgs/srv/SetMode").split("---\n")
        client = await loop.run_in_executor(
            None,
            partial(
                sdk.ROS2ServiceClient,
                service_name="/mavros/set_mode",
                srv_type="mavros_msgs/srv/SetMode",
                request_definition=request,
                response_definition=response,
                **place,
            ),
        )
        answer = await loop.run_in_executor(None, partial(client.call, base_mode=0, custom_mode="GUIDED"))
        assert answer.mode_sent is True
        topics = dict(
            await loop.run_in_executor(None, partial(sdk.get_topic_names_and_types, domain_id=0, **place))
        )
        assert topics["/mavros/state"] == [STATE]
        assert topics["/mavros/setpoint_velocity/cmd_vel"] == ["geometry_msgs/msg/TwistStamped"]
        info = await loop.run_in_executor(
            None,
            partial(sdk.get_topic_info, topic_name="/mavros/imu/data", domain_id=0, verbose=True, **place),
        )
        assert info.publishers[0].node_name.strip("/") == "mavstack"
        assert info.publishers[0].type_hash == type_hash(IMU)
        subscriber.close()
        client.close()

    run(router, scenario)


def test_a_late_subscriber_gets_states(router: int) -> None:
    zenoh = pytest.importorskip("zenoh")

    async def scenario(connection: Any, bridge: Any, sink: ZenohSink) -> None:
        await until(lambda: bridge.vehicles[1].mapper.topics["state"].published > 1)
        got: list[Any] = []
        session = zenoh_client(router)
        key = key_of(0, "/mavros/state", STATE)
        history = zenoh.ext.HistoryConfig(detect_late_publishers=True)
        late = zenoh.ext.declare_advanced_subscriber(session, key, got.append, history=history)
        await until(lambda: got)
        fields = codec_of(STATE).decode_fields(bytes(got[0].payload))
        assert fields["connected"] is True
        sequence, stamp, _ = parse_attachment(bytes(got[0].attachment))
        assert sequence >= 1
        assert stamp > 1_600_000_000_000_000_000
        late.undeclare()
        session.close()

    run(router, scenario)


def test_a_topic_costs_nothing_when_its_last_subscriber_leaves(router: int) -> None:
    async def scenario(connection: Any, bridge: Any, sink: ZenohSink) -> None:
        topic = bridge.vehicles[1].mapper.topics["imu/data"]
        session = zenoh_client(router)
        await asyncio.sleep(1)
        assert topic.published == 0
        subscriber = session.declare_subscriber(key_of(0, "/mavros/imu/data", IMU), lambda sample: None)
        await until(lambda: topic.published > 3)
        subscriber.undeclare()
        await until(lambda: not topic.active)
        session.close()

    run(router, scenario)


def test_a_burst_of_reliable_samples_arrives(router: int) -> None:
    """All parameters of a vehicle come at once, beside streams of sensors."""
    event, count = "mavros_msgs/msg/ParamEvent", 3000

    async def scenario(connection: Any, bridge: Any, sink: ZenohSink) -> None:
        vehicle = bridge.vehicles[1]
        session = zenoh_client(router)
        got: list[int] = []

        def receive(sample: Any) -> None:
            got.append(codec_of(event).decode_fields(bytes(sample.payload))["param_index"])

        session.declare_subscriber(key_of(0, "/mavros/param/event", event), receive)
        await until(lambda: vehicle.mapper.topics["param/event"].active)
        for number in range(count):
            vehicle.publish("param/event", ("NAME", 3, False, 0, 1.5, "", b"", *((),) * 4, number, count))
        await until(lambda: got[-1:] == [count - 1])
        assert got == list(range(count))
        session.close()

    run(router, scenario)


def test_what_others_send_ends_nothing(router: int) -> None:
    """Samples and requests of random bytes on all keys of the bridge: counted, and answered by an error."""

    async def scenario(connection: Any, bridge: Any, sink: ZenohSink) -> None:
        from random import Random

        rng = Random(1)
        vehicle = bridge.vehicles[1]
        await until(lambda: not bridge._attaching)
        session = zenoh_client(router)
        for inlet in vehicle.inlets:
            for size in (0, 3, 40):
                session.put(
                    key_of(0, inlet.name, inlet.type), rng.randbytes(size), attachment=rng.randbytes(5)
                )
        await until(lambda: sum(inlet.refused for inlet in vehicle.inlets) > 100)
        for service in vehicle.services[:10]:
            replies = session.get(key_of(0, service.name, service.type), payload=b"\xff" * 7, timeout=5)
            answers = await asyncio.get_running_loop().run_in_executor(None, list, replies)
            assert all(answer.ok is None for answer in answers)
        state = vehicle.mapper.topics["state"]
        before = state.published
        await until(lambda: state.published > before)
        session.close()

    run(router, scenario)


def test_a_setpoint_that_the_network_held_back_is_refused(router: int) -> None:
    async def scenario(connection: Any, bridge: Any, sink: ZenohSink) -> None:
        inlets = {inlet.row.name: inlet for inlet in bridge.vehicles[1].inlets}
        inlet = inlets["setpoint_velocity/cmd_vel_unstamped"]
        await until(lambda: not bridge._attaching)
        session = zenoh_client(router)
        sample, key = codec_of(inlet.type).encode_fields({}), key_of(0, inlet.name, inlet.type)
        stamp, gid = time.time_ns(), bytes(range(16))
        for number, late in enumerate((0, 5_000_000_000)):
            session.put(key, sample, attachment=attachment_of(number, stamp - late, gid))
        await until(lambda: inlet.accepted + inlet.refused == 2)
        assert (inlet.accepted, inlet.refused) == (1, 1)
        assert "later than others of its publisher" in inlet.last_reason
        session.close()

    run(router, scenario)


def test_no_router() -> None:
    async def scenario() -> None:
        with pytest.raises(LinkError, match=r"connecting to the Zenoh router tcp/127.0.0.1:\d+ failed"):
            await ZenohSink(0, [f"tcp/127.0.0.1:{free_port()}"]).open()

    asyncio.run(scenario())


def test_endpoints_have_no_threads(router: int) -> None:
    """A bridge of many vehicles must not have a thread for each of its endpoints."""
    import threading

    async def scenario(connection: Any, bridge: Any, sink: ZenohSink) -> None:
        await until(lambda: bridge.vehicles and not bridge._attaching)
        assert threading.active_count() < 30

    run(router, scenario)
