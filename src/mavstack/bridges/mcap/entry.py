"""The entry of the recording as MCAP: its options."""

from __future__ import annotations

from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.naming_options import add_naming_options, make_bridge
from mavstack.bridges.core.registry import BridgeEntry

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Connection

_EXAMPLES: Final = (
    "mav bridge mcap udpin://0.0.0.0:14550 --output flight.mcap   # for ros2 bag play, and Foxglove",
)


def add_options(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--output", type=Path, required=True, metavar="FILE", help="new file")
    add_naming_options(parser)


@asynccontextmanager
async def serve(arguments: Namespace, connection: Connection) -> AsyncIterator[str]:
    """Record; its value is the line that says that the recording runs."""
    from mavstack.bridges.mcap.sink import McapSink

    async with make_bridge(connection, McapSink(arguments.output), arguments):
        yield f"recording the topics of ROS 2 into {arguments.output}"


ENTRY: Final = BridgeEntry("record the topics of ROS 2 as MCAP, without ROS", _EXAMPLES, add_options, serve)
