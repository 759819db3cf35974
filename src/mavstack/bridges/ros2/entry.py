"""The entry of the bridge to ROS 2: its options, and the sink that they choose."""

from __future__ import annotations

from argparse import ArgumentTypeError
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.naming_options import add_naming_options, make_bridge
from mavstack.bridges.core.registry import BridgeEntry
from mavstack.bridges.core.zenoh_session import DEFAULT_ROUTER

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.bridges.core.sink import Sink
    from mavstack.vehicle import Connection

_EXAMPLES: Final = (
    "mav bridge ros2 udpin://0.0.0.0:14550   # ROS 2 with rmw_zenoh, by its router here",
    "mav bridge ros2 udpin://0.0.0.0:14550 --connect tcp/192.168.1.5:7447 --allow-control",
    "mav bridge ros2 udpin://0.0.0.0:14550 --via rclpy   # inside a ROS installation, with any middleware",
    "mav bridge ros2 udpin://0.0.0.0:14550 --via dds   # topics only, without a ROS installation",
    "mav bridge ros2 udpin://0.0.0.0:14550 --fleet --name 1=alpha --name 2=beta",
)
MAX_DOMAIN: Final = 232


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add(
        "--via",
        choices=("zenoh", "rclpy", "dds"),
        default="zenoh",
        help="the way to ROS: its middleware rmw_zenoh, its client library, or DDS (default: zenoh)",
    )
    add(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help=f"with zenoh: the router, may be repeated (default: {DEFAULT_ROUTER})",
    )
    add("--domain", type=domain_number, default=0, metavar="N", help="ROS_DOMAIN_ID (default: 0)")
    add_naming_options(parser)


@asynccontextmanager
async def serve(arguments: Namespace, connection: Connection) -> AsyncIterator[str]:
    """Run the bridge; its value is the line that says that it is ready."""
    sink, where = _sink(arguments)
    async with make_bridge(connection, sink, arguments):
        yield f"ROS 2 domain {arguments.domain} {where}"


def domain_number(text: str) -> int:
    """Return a ROS_DOMAIN_ID, for argparse."""
    if not text.isdecimal() or int(text) > MAX_DOMAIN:
        raise ArgumentTypeError(f"must be from 0 to {MAX_DOMAIN}, got {text}")
    return int(text)


def _sink(arguments: Namespace) -> tuple[Sink, str]:
    made: Any
    if arguments.via == "rclpy":
        from mavstack.bridges.ros2.rclpy_sink import RclpySink

        made = RclpySink(arguments.domain)
        return made, f"by rclpy ({made.middleware})"
    if arguments.via == "dds":
        from mavstack.bridges.ros2.dds_sink import DdsSink

        return DdsSink(arguments.domain), "over DDS: topics only, no services and actions"
    from mavstack.bridges.ros2.zenoh_sink import ZenohSink

    routers = arguments.connect or [DEFAULT_ROUTER]
    return ZenohSink(arguments.domain, routers), f"over Zenoh by {', '.join(routers)}"


ENTRY: Final = BridgeEntry(
    "vehicles in ROS 2, with the names and types of MAVROS", _EXAMPLES, add_options, serve
)
