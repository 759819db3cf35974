"""Samples from rclpy, by stand-ins for its modules: what it says about a message comes to the vehicle."""

from __future__ import annotations

import asyncio
import inspect
import sys
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.qos import DEFAULT
from mavstack.bridges.ros2.rclpy_sink import RclpySink

if TYPE_CHECKING:
    import pytest

SENT = 1_700_000_000_000_000_000
MODULES = ("rclpy", "rclpy.executors", "rclpy.callback_groups", "rclpy.qos", "geometry_msgs.msg")


class StandIn(SimpleNamespace):
    """An object of rclpy: every attribute exists, and every call returns another one."""

    def __getattr__(self, name: str) -> Any:
        return StandIn()

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        return StandIn()


class Node:
    """A node that keeps the callbacks of its subscriptions."""

    def __init__(self) -> None:
        self.callbacks: list[Any] = []

    def create_subscription(self, _kind: Any, _name: str, callback: Any, _qos: Any, *, raw: bool) -> None:
        assert raw
        self.callbacks.append(callback)

    def destroy_node(self) -> None:
        pass


class Inlet:
    """A topic for a vehicle that notes what arrives."""

    type, name, node, qos = "geometry_msgs/msg/Twist", "/cmd_vel", "/mavros/node", DEFAULT

    def __init__(self) -> None:
        self.received: list[tuple[bytes, str, int]] = []

    def receive(self, payload: bytes, source: str, sent: int) -> None:
        self.received.append((payload, source, sent))


async def test_the_time_of_the_publisher_comes_with_a_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages such as Twist have no header; their age is by the time that the middleware sends."""
    for name in MODULES:
        monkeypatch.setitem(sys.modules, name, StandIn())
    node, inlet = Node(), Inlet()
    sink = RclpySink(0)
    await sink.open()
    sink._nodes[inlet.node] = node
    sink.add_inlet(inlet)
    (callback,) = node.callbacks
    assert len(inspect.signature(callback).parameters) == 2  # by this number rclpy decides what it passes
    publisher = {"implementation_identifier": "rmw_fastrtps_cpp", "data": b"\x01\x0f"}
    callback(bytearray(b"one"), {"source_timestamp": SENT, "publisher_gid": publisher})
    callback(bytearray(b"two"), {"source_timestamp": SENT, "received_timestamp": SENT + 1})
    callback(bytearray(b"three"), {})
    await asyncio.sleep(0.01)
    await sink.close()
    assert inlet.received == [(b"one", "010f", SENT), (b"two", "", SENT), (b"three", "", 0)]
