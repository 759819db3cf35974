"""The entry of the export to OpenTelemetry: its options."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.naming_options import add_names_option
from mavstack.bridges.core.registry import BridgeEntry

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Connection

_EXAMPLES: Final = ("mav bridge otel udpin://0.0.0.0:14550 --otlp http://127.0.0.1:4318",)
#: The default port of collectors for OTLP over HTTP.
DEFAULT_COLLECTOR: Final = "http://127.0.0.1:4318"


def add_options(parser: ArgumentParser) -> None:
    """Declare the options; `--otlp` is an option of all bridges."""
    parser.set_defaults(otlp=DEFAULT_COLLECTOR)
    add_names_option(parser)


@asynccontextmanager
async def serve(arguments: Namespace, connection: Connection) -> AsyncIterator[str]:
    """Export metrics; its value is the line that says that the bridge is ready."""
    from mavstack.bridges.otel.exporting import exported_metrics

    names = {system: name.strip("/") for system, name in arguments.name}
    async with exported_metrics(arguments.otlp, connection, names):
        yield f"OpenTelemetry {arguments.otlp}"


ENTRY: Final = BridgeEntry("metrics and spans of operations for OpenTelemetry", _EXAMPLES, add_options, serve)
