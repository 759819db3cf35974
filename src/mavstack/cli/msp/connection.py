"""The URL of a flight controller, and its connection."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.bridges.msp.flight_controller import FlightController
from mavstack.bridges.msp.transport import transport_url
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable


def add_connection(parser: ArgumentParser) -> None:
    """Declare the URL, the baud rate and `--json`."""
    parser.add_argument("url", metavar="URL", help="serial device, or msp+tcp://HOST:PORT")
    parser.add_argument(
        "--baud", type=int, metavar="N", help="baud rate of a serial port (default: 115200; USB ignores it)"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run_on_controller(arguments: Namespace, work: Callable[[FlightController], Awaitable[int]]) -> int:
    """Open the controller, do the work, and return its exit code."""
    if arguments.baud is not None and arguments.baud <= 0:
        raise UsageError(f"--baud must be above 0, got {arguments.baud}")
    url = transport_url(arguments.url, arguments.baud)

    async def run() -> int:
        async with FlightController(url) as controller:
            return await work(controller)

    return run_until_signal(run())
