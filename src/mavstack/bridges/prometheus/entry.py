"""The entry of the bridge to Prometheus: its options."""

from __future__ import annotations

from contextlib import asynccontextmanager
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.bridges.core.naming_options import add_names_option, port_number, url_host
from mavstack.bridges.core.registry import BridgeEntry

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Connection

_EXAMPLES: Final = (
    "mav bridge prometheus udpin://0.0.0.0:14550 --port 9464   # http://127.0.0.1:9464/metrics",
    "mav bridge prometheus udpin://0.0.0.0:14550 --dashboard vehicles.json --alerts vehicles.yml",
)
#: OpenTelemetry's default port for Prometheus exporters; no other known exporter uses it.
DEFAULT_PORT: Final = 9464
DASHBOARD: Final = "grafana.json"
ALERTS: Final = "alerts.yml"


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("--port", type=port_number, default=DEFAULT_PORT, metavar="N", help="0: any (default: 9464)")
    add("--host", default="127.0.0.1", metavar="ADDRESS", help="address to listen on (default: 127.0.0.1)")
    add("--dashboard", type=Path, metavar="FILE", help="write a dashboard for Grafana")
    add("--alerts", type=Path, metavar="FILE", help="write rules for alerts of Prometheus")
    add_names_option(parser)


@asynccontextmanager
async def serve(arguments: Namespace, connection: Connection) -> AsyncIterator[str]:
    """Run the bridge; its value is the line that says that it is ready."""
    from mavstack.bridges.prometheus.exporter import MetricsServer

    for path, name in ((arguments.dashboard, DASHBOARD), (arguments.alerts, ALERTS)):
        if path is not None:
            write_file_atomically(path, shipped(name))
    names = {system: name.strip("/") for system, name in arguments.name}
    async with MetricsServer(connection, arguments.host, arguments.port, names) as server:
        yield f"Prometheus http://{url_host(arguments.host)}:{server.port}/metrics"


def shipped(name: str) -> str:
    """Return a file of this package: the dashboard, or the rules."""
    return (files("mavstack.bridges.prometheus") / name).read_text("utf-8")


ENTRY: Final = BridgeEntry(
    "metrics of vehicles for Prometheus, a dashboard for Grafana, alerts", _EXAMPLES, add_options, serve
)
