"""`mav msp bridge`: a flight controller as a MAVLink vehicle for other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.bridges.msp.bridge import MspBridge
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.msp.connection import run_on_controller

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.links import Link

_MAX_SYSTEM = 255


def bridge(arguments: Namespace) -> int:
    """Run `mav msp bridge`."""
    if not 1 <= arguments.system <= _MAX_SYSTEM:
        raise UsageError(f"--system must be from 1 to {_MAX_SYSTEM}, got {arguments.system}")

    async def work(controller: FlightController) -> int:
        async with MspBridge(controller, *arguments.links, system=arguments.system) as opened:
            _announce(arguments, opened)
            await opened.serve_forever()
        return 0

    return run_on_controller(arguments, work)


def _announce(arguments: Namespace, bridge: MspBridge) -> None:
    info = bridge.controller.info
    links = [_name(link) for link in bridge.node.links]
    system, component = bridge.node.address
    if arguments.json:
        echo_json({"firmware": info.variant, "system": system, "component": component, "links": links})
    else:
        who = f"{info.firmware} {info.version_text}"
        echo(f"{who} is vehicle {system}/{component} on {', '.join(links)}; Ctrl-C to end")


def _name(link: Link) -> str:
    """Return the URL of a link, with the port that the system chose for 0."""
    chosen = link.address if link.url.port == 0 else None
    return link.url.redacted if chosen is None else f"{link.url.scheme}://{chosen[0]}:{chosen[1]}"
