"""Actions over Zenoh with an independent implementation of rmw_zenoh's wire as the client.

It has no class for actions; their three services and two topics are used as what they are. The definitions
are written here without nested types, whose encoding is the same.
"""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.action_server import ABORTED, CANCELED, SUCCEEDED
from mavstack.bridges.core.types import message_text, type_hash
from tests.bridges.ros2.running import until, zenoh_ros2_sdk, zenoh_router
from tests.bridges.ros2.test_zenoh_sink import run

if TYPE_CHECKING:
    from collections.abc import Iterator

np = pytest.importorskip("numpy")
pytestmark = [pytest.mark.interop, pytest.mark.filterwarnings("ignore")]
TAKEOFF = "mavstack_msgs/action/Takeoff"
STATUSES = "action_msgs/msg/GoalStatusArray"
#: The services of an action: their types, and the fields of request and response.
SERVICES = {
    "send_goal": (
        f"{TAKEOFF}_SendGoal",
        "uint8[16] goal_id\nfloat64 altitude",
        "bool accepted\nint32 sec\nuint32 nanosec",
    ),
    "get_result": (f"{TAKEOFF}_GetResult", "uint8[16] goal_id", "int8 status\nbool success\nstring reason"),
    "cancel_goal": (
        "action_msgs/srv/CancelGoal",
        "uint8[16] goal_id\nint32 sec\nuint32 nanosec",
        message_text("action_msgs/srv/CancelGoal_Response"),
    ),
}


@pytest.fixture(name="router")
def _router() -> Iterator[int]:
    with zenoh_router() as port:
        yield port


class ActionClient:
    """A client of `/mavros/action/takeoff`."""

    def __init__(self, router: int) -> None:
        self.sdk = zenoh_ros2_sdk()
        place = {"router_ip": "127.0.0.1", "router_port": router}
        self.prefix = "/mavros/action/takeoff/_action"
        self.altitudes: list[float] = []
        self.statuses: list[list[int]] = []
        self.services = {
            name: self.sdk.ROS2ServiceClient(
                service_name=f"{self.prefix}/{name}",
                srv_type=kind,
                request_definition=request,
                response_definition=response,
                type_hash=type_hash(kind),
                timeout=60.0,
                **place,
            )
            for name, (kind, request, response) in SERVICES.items()
        }
        self.topics = [
            self.sdk.ROS2Subscriber(
                topic=f"{self.prefix}/{name}",
                msg_type=kind,
                msg_definition=definition,
                type_hash=type_hash(kind),
                callback=callback,
                **place,
            )
            for name, kind, definition, callback in (
                (
                    "feedback",
                    f"{TAKEOFF}_FeedbackMessage",
                    "uint8[16] goal_id\nfloat64 altitude",
                    lambda message: self.altitudes.append(message.altitude),
                ),
                (
                    "status",
                    STATUSES,
                    message_text(STATUSES),
                    lambda message: self.statuses.append([each.status for each in message.status_list]),
                ),
            )
        ]

    def call(self, name: str, goal: int, **fields: Any) -> Any:
        return self.services[name].call(goal_id=np.full(16, goal, np.uint8), **fields)

    def close(self) -> None:
        for each in (*self.services.values(), *self.topics):
            each.close()


def test_goals_are_reached_refused_and_cancelled(router: int) -> None:
    async def scenario(connection: Any, bridge: Any, sink: Any) -> None:
        await until(lambda: not bridge._attaching)
        loop = asyncio.get_running_loop()
        client = await loop.run_in_executor(None, ActionClient, router)
        try:
            await fly(connection.vehicles[1], client)
        finally:
            client.close()

    async def fly(vehicle: Any, client: ActionClient) -> None:
        loop = asyncio.get_running_loop()

        async def call(name: str, goal: int, **fields: Any) -> Any:
            return await loop.run_in_executor(None, partial(client.call, name, goal, **fields))

        assert (await call("send_goal", 1, altitude=-5.0)).accepted
        result = await call("get_result", 1)
        assert (result.status, result.success) == (ABORTED, False)
        assert "takeoff altitude must be positive" in result.reason
        await vehicle.wait_until_ready()
        await vehicle.set_mode("GUIDED")
        await vehicle.arm()
        assert (await call("send_goal", 2, altitude=4.0)).accepted
        result = await call("get_result", 2)
        assert (result.status, result.success, result.reason) == (SUCCEEDED, True, "")
        assert max(client.altitudes) > 1.0
        await vehicle.land()
        await vehicle.set_mode("GUIDED")
        await vehicle.arm()
        assert (await call("send_goal", 3, altitude=60.0)).accepted
        await until(lambda: vehicle.position.relative_altitude > 1.0)
        cancelled = await call("cancel_goal", 3, sec=0, nanosec=0)
        assert cancelled.return_code == 0
        assert [each.goal_id.uuid[0] for each in cancelled.goals_canceling] == [3]
        result = await call("get_result", 3)
        assert (result.status, result.success) == (CANCELED, False)
        await until(lambda: client.statuses[-1:] == [[ABORTED, SUCCEEDED, CANCELED]])
        unknown = await call("cancel_goal", 9, sec=0, nanosec=0)
        assert unknown.return_code == 2

    run(router, scenario, speed=3.0)
