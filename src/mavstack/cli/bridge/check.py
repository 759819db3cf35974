"""`mav bridge check`: who is connected with the vehicles on a bus, and why others are not."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.naming_options import port_number, url_host
from mavstack.bridges.core.zenoh_session import DEFAULT_ROUTER, SessionOptions
from mavstack.bridges.foxglove.entry import DEFAULT_PORT as FOXGLOVE_PORT
from mavstack.bridges.mqtt.entry import broker_url, topic_prefix
from mavstack.bridges.otel.entry import DEFAULT_COLLECTOR
from mavstack.bridges.prometheus.entry import DEFAULT_PORT as PROMETHEUS_PORT
from mavstack.bridges.ros2.entry import domain_number
from mavstack.bridges.zenoh.keys import DEFAULT_PREFIX, checked_prefix
from mavstack.cli.common.output import coloured, echo, echo_json

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Coroutine, Mapping, Sequence

    from mavstack.bridges.core.finding import Finding

EXAMPLES: Final = (
    "mav bridge check                        # peers, wrong type hashes, profiles that do not fit",
    "mav bridge check zenoh                  # the gateways of a fleet, and their vehicles",
    "mav bridge check mqtt --broker mqtt://127.0.0.1        # vehicles on a broker, and their answers",
    "mav bridge check foxglove --port 8765",
    "mav bridge check prometheus --port 9464",
    "mav bridge check otel --otlp http://127.0.0.1:4318",
)


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("bus", nargs="?", choices=_CHECKS, default="ros2", help="the bus (default: ros2, over Zenoh)")
    add(
        "--connect",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help=f"with ros2 and zenoh: the Zenoh router (default: {DEFAULT_ROUTER})",
    )
    add("--domain", type=domain_number, default=0, metavar="N", help="with ros2: ROS_DOMAIN_ID")
    add(
        "--prefix",
        type=topic_prefix,
        default=DEFAULT_PREFIX,
        help=f"with zenoh and mqtt: the beginning of all keys or topics (default: {DEFAULT_PREFIX})",
    )
    add("--broker", type=broker_url, default="mqtt://127.0.0.1", metavar="URL", help="with mqtt: the broker")
    add("--host", default="127.0.0.1", metavar="ADDRESS", help="with foxglove and prometheus: the bridge")
    add("--port", type=port_number, metavar="N", help="its port (default: that of the bridge)")
    add("--otlp", default=DEFAULT_COLLECTOR, metavar="URL", help="with otel: the collector")
    add("--json", action="store_true", help="print JSON")


def check(arguments: Namespace) -> int:
    """Run `mav bridge check`; the exit code is 1 if something does not work."""
    found = asyncio.run(_CHECKS[arguments.bus](arguments))
    if arguments.json:
        echo_json([asdict(each) for each in found])
    else:
        echo(*map(_line, found))
    return 0 if all(each.ok for each in found) else 1


def _line(finding: Finding) -> str:
    word = coloured("ok     ", "green") if finding.ok else coloured("problem", "red")
    return f"{word}  {finding.text}"


async def _check_ros2(arguments: Namespace) -> Sequence[Finding]:
    from mavstack.bridges.ros2.graph_check import check_graph
    from mavstack.bridges.ros2.zenoh_sink import ZenohSink

    sink = ZenohSink(arguments.domain, arguments.connect or [DEFAULT_ROUTER])
    await sink.open()
    try:
        return check_graph(await sink.graph(), arguments.domain)
    finally:
        await sink.close()


async def _check_zenoh(arguments: Namespace) -> Sequence[Finding]:
    from mavstack.bridges.zenoh.fleet_check import check_fleet

    options = SessionOptions(tuple(arguments.connect) or (DEFAULT_ROUTER,))
    return await check_fleet(options, checked_prefix(arguments.prefix))


async def _check_mqtt(arguments: Namespace) -> Sequence[Finding]:
    from mavstack.bridges.mqtt.broker_check import check_broker

    return await check_broker(arguments.broker, arguments.prefix)


async def _check_foxglove(arguments: Namespace) -> Sequence[Finding]:
    from mavstack.bridges.foxglove.server_check import check_server

    return await check_server(f"ws://{url_host(arguments.host)}:{arguments.port or FOXGLOVE_PORT}")


async def _check_prometheus(arguments: Namespace) -> Sequence[Finding]:
    from mavstack.bridges.prometheus.scrape_check import check_metrics

    port = arguments.port or PROMETHEUS_PORT
    return await check_metrics(f"http://{url_host(arguments.host)}:{port}/metrics")


async def _check_otel(arguments: Namespace) -> Sequence[Finding]:
    from mavstack.bridges.otel.collector_check import check_collector

    return await check_collector(arguments.otlp)


_CHECKS: Final[Mapping[str, Callable[[Namespace], Coroutine[Any, Any, Sequence[Finding]]]]] = (
    MappingProxyType(
        {
            "ros2": _check_ros2,
            "zenoh": _check_zenoh,
            "mqtt": _check_mqtt,
            "foxglove": _check_foxglove,
            "prometheus": _check_prometheus,
            "otel": _check_otel,
        }
    )
)
