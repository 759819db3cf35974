"""`mav bridge check`: who is connected with the vehicles over Zenoh, and why others are not."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import TYPE_CHECKING

from mavstack.bridges.core.zenoh_session import DEFAULT_ROUTER, SessionOptions
from mavstack.bridges.ros2.entry import domain_number
from mavstack.bridges.zenoh.keys import DEFAULT_PREFIX
from mavstack.cli.common.output import coloured, echo, echo_json

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.bridges.ros2.graph_check import Finding
    from mavstack.bridges.zenoh.fleet_check import FleetFinding


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "bus",
        nargs="?",
        choices=("ros2", "zenoh"),
        default="ros2",
        help="nodes of ROS 2, or the gateways of a fleet (default: ros2)",
    )
    parser.add_argument(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help=f"the Zenoh router (default: {DEFAULT_ROUTER})",
    )
    parser.add_argument("--domain", type=domain_number, default=0, metavar="N", help="ROS_DOMAIN_ID")
    parser.add_argument(
        "--prefix",
        default=DEFAULT_PREFIX,
        help=f"with zenoh: the beginning of all keys of the fleet (default: {DEFAULT_PREFIX})",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def check(arguments: Namespace) -> int:
    """Run `mav bridge check`; the exit code is 1 if something does not work."""
    found = asyncio.run(_findings(arguments, arguments.connect or [DEFAULT_ROUTER]))
    if arguments.json:
        echo_json([asdict(each) for each in found])
    else:
        echo(*map(_line, found))
    return 0 if all(each.ok for each in found) else 1


def _line(finding: Finding | FleetFinding) -> str:
    word = coloured("ok     ", "green") if finding.ok else coloured("problem", "red")
    return f"{word}  {finding.text}"


async def _findings(arguments: Namespace, routers: list[str]) -> Sequence[Finding | FleetFinding]:
    from mavstack.bridges.ros2.graph_check import check_graph
    from mavstack.bridges.ros2.zenoh_sink import ZenohSink
    from mavstack.bridges.zenoh.fleet_check import check_fleet

    if arguments.bus == "zenoh":
        return await check_fleet(SessionOptions(tuple(routers)), arguments.prefix)
    sink = ZenohSink(arguments.domain, routers)
    await sink.open()
    try:
        return check_graph(await sink.graph(), arguments.domain)
    finally:
        await sink.close()
