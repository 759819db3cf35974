"""`mav bridge check`: who is connected with the vehicles in ROS 2 over Zenoh, and why others are not."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import TYPE_CHECKING

from mavstack.bridges.core.zenoh_session import DEFAULT_ROUTER
from mavstack.bridges.ros2.entry import domain_number
from mavstack.cli.common.output import coloured, echo, echo_json

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.bridges.ros2.graph_check import Finding


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help=f"the Zenoh router (default: {DEFAULT_ROUTER})",
    )
    parser.add_argument("--domain", type=domain_number, default=0, metavar="N", help="ROS_DOMAIN_ID")
    parser.add_argument("--json", action="store_true", help="print JSON")


def check(arguments: Namespace) -> int:
    """Run `mav bridge check`; the exit code is 1 if something does not work."""
    found = asyncio.run(_findings(arguments.domain, arguments.connect or [DEFAULT_ROUTER]))
    if arguments.json:
        echo_json([asdict(each) for each in found])
    else:
        echo(*map(_line, found))
    return 0 if all(each.ok for each in found) else 1


def _line(finding: Finding) -> str:
    word = coloured("ok     ", "green") if finding.ok else coloured("problem", "red")
    return f"{word}  {finding.text}"


async def _findings(domain: int, routers: list[str]) -> list[Finding]:
    from mavstack.bridges.ros2.graph_check import check_graph
    from mavstack.bridges.ros2.zenoh_sink import ZenohSink

    sink = ZenohSink(domain, routers)
    await sink.open()
    try:
        return check_graph(await sink.graph(), domain)
    finally:
        await sink.close()
