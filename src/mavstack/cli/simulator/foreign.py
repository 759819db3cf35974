"""`mav simulator vehicle`: vehicles of Mavstack in the worlds of other simulators."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.sim.arguments import home
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.foreign import ForeignVehicle
from mavstack.simulators.foreign.loops import LOOPS

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.cli.common.actions import Actions

_TARGETS: Final = {"px4": "tcpout://127.0.0.1:4560", "ardupilot": "udpout://127.0.0.1:9002"}


def add_vehicle_arguments(actions: Actions) -> None:
    """Declare the action."""
    action = actions.add("vehicle", "fly a vehicle of Mavstack in another simulator", fly_vehicle)
    add = action.add_argument
    add("firmware", choices=tuple(_TARGETS), help="the firmware as which it connects to the simulator")
    add(
        "--type",
        dest="vehicle_type",
        choices=[kind.value for kind in LOOPS],
        default="copter",
        help="the vehicle (default: copter)",
    )
    add("--to", metavar="URL", help=f"the simulator (default: {' or '.join(_TARGETS.values())})")
    add(
        "--out",
        action="append",
        default=[],
        metavar="URL",
        help="a link to clients; may be repeated (default: udpout://127.0.0.1:14550)",
    )
    add(
        "--home",
        type=home,
        default=DEFAULT_HOME,
        metavar="LAT,LON,ALT,HDG",
        help="with ardupilot: its origin",
    )
    add(
        "--speed",
        type=float,
        default=1.0,
        metavar="FACTOR",
        help="with ardupilot: simulated seconds in a real second; 0: as fast as possible (default: 1)",
    )
    add("--seed", type=int, default=1, metavar="N", help="seed of the estimate's noise (default: 1)")
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after this real time")
    add("--json", action="store_true", help="print JSON")


def fly_vehicle(arguments: Namespace) -> int:
    """Run `mav simulator vehicle`."""
    return run_until_signal(_fly(arguments))


async def _fly(arguments: Namespace) -> int:
    def report(line: str, event: str = "connected") -> None:
        if arguments.json:
            echo_json({"event": event, "text": line})
        else:
            echo(line)

    to = arguments.to or _TARGETS[arguments.firmware]
    vehicle = ForeignVehicle(
        arguments.firmware,
        arguments.vehicle_type,
        to=to,
        links=arguments.out or ["udpout://127.0.0.1:14550"],
        home=arguments.home,
        seed=arguments.seed,
        speed=arguments.speed,
        on_event=report,
    )
    async with vehicle:
        report(f"ready: it connects to {to}", "ready")
        try:
            async with asyncio.timeout(arguments.seconds):
                await vehicle.run()
        except TimeoutError:
            return 0
    report("the simulator disconnected", "disconnected")
    return 1
