"""The entry of the bridge to Foxglove: its options."""

from __future__ import annotations

from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.naming_options import (
    add_naming_options,
    first_namespace,
    make_bridge,
    port_number,
    url_host,
)
from mavstack.bridges.core.registry import BridgeEntry
from mavstack.errors import MissingExtraError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Connection

_EXAMPLES: Final = (
    "mav bridge foxglove udpin://0.0.0.0:14550 --port 8765   # open ws://127.0.0.1:8765 in Foxglove",
    "mav bridge foxglove udpin://0.0.0.0:14550 --layout mavstack.json --allow-control",
)
DEFAULT_PORT: Final = 8765


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("--port", type=port_number, default=DEFAULT_PORT, metavar="N", help="0: any (default: 8765)")
    add("--host", default="127.0.0.1", metavar="ADDRESS", help="address to listen on (default: 127.0.0.1)")
    add("--layout", type=Path, metavar="FILE", help="write a layout for Foxglove that shows a vehicle")
    add_naming_options(parser)


@asynccontextmanager
async def serve(arguments: Namespace, connection: Connection) -> AsyncIterator[str]:
    """Run the bridge; its value is the line that says that it is ready."""
    try:
        import foxglove  # noqa: F401
    except ImportError:
        raise MissingExtraError("the bridge to Foxglove", "foxglove") from None
    from mavstack.bridges.foxglove.layout import write_layout
    from mavstack.bridges.foxglove.parameters import FoxgloveParameters
    from mavstack.bridges.foxglove.sink import FoxgloveSink

    role = arguments.role
    sink = FoxgloveSink(arguments.host, arguments.port, control=role > Role.OBSERVE)
    bridge = make_bridge(connection, sink, arguments)
    sink.parameters = FoxgloveParameters(bridge.vehicles, role, sink.publish_parameters)
    if arguments.layout is not None:
        write_layout(arguments.layout, first_namespace(arguments))
    async with bridge:
        yield f"Foxglove ws://{url_host(arguments.host)}:{sink.port}"


ENTRY: Final = BridgeEntry(
    "vehicles live in Foxglove: map, 3D view, plots, parameters, services", _EXAMPLES, add_options, serve
)
