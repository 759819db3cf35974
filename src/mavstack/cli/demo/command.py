"""`mav demo`: a simulated fleet that flies missions, with a live display, all on this machine."""

from __future__ import annotations

import sys
from contextlib import AsyncExitStack, nullcontext
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.link_options import add_link_options, with_link_options
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.cli.demo.fleet_state import FleetState
    from mavstack.node import Node
    from mavstack.sim.runner import Runner

EXAMPLES: Final = """\
examples:
  mav demo                     # eight vehicles on missions, live, until Ctrl-C
  mav demo --web               # with the ground station in the browser
  mav demo --swarm             # six copters as one: a formation, a show and a search
  mav demo --speed 5           # five times as fast
  mav demo --for 60 --once     # a summary after one simulated minute
  mav demo --once --json       # the summary as one JSON object

With --out udpout://127.0.0.1:14550 another terminal or a ground station can watch:
  mav watch udpin://127.0.0.1:14550
"""

#: System id of the ground station that flies the missions.
_OWN_SYSTEM: Final = 254
#: Simulated seconds until a summary is printed.
_SUMMARY_DURATION: Final = 60.0
_SWARM_DURATION: Final = 330.0


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    add = parser.add_argument
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after this simulated time")
    add("--speed", type=seconds, default=1.0, metavar="N", help="simulated seconds per second (default: 1)")
    add("--once", action="store_true", help="simulate as fast as possible, and print a summary")
    add("--json", action="store_true", help="print the summary as one JSON object")
    add(
        "--out",
        action="append",
        default=[],
        metavar="URL",
        help="link on which other programs can reach the vehicles with MAVLink",
    )
    add("--swarm", action="store_true", help="six copters as a swarm: a formation, a show and a search")
    add("--web", action="store_true", help="serve the ground station in the browser too")
    add(
        "--port",
        type=int,
        default=8080,
        metavar="N",
        help="port of the ground station; 0: a free one (default: 8080)",
    )
    add("--seed", type=int, default=1, metavar="N", help="seed of all random numbers (default: 1)")
    add_link_options(parser.add_argument_group("links"), identity=False)


def run(arguments: Namespace) -> int:
    """Run `mav demo`."""
    _choose_output(arguments)
    if arguments.once and not (arguments.out or arguments.web):
        from mavstack.sim.virtual import run_virtually

        return run_virtually(_demo(arguments))
    return run_until_signal(_demo(arguments))


async def _demo(arguments: Namespace) -> int:
    from mavstack.cli.demo.fleet_state import FleetState
    from mavstack.cli.demo.flights import add_vehicles, fly_missions
    from mavstack.cli.demo.racing_drone import add_racing_drone, bridged
    from mavstack.cli.demo.station import station_served
    from mavstack.cli.demo.swarm_flights import add_swarm, fly_swarm
    from mavstack.cli.watch.link_follower import background_tasks
    from mavstack.dialects import Dialect
    from mavstack.links import MemoryNetwork
    from mavstack.node import Node
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation

    dialect = Dialect.load("all")
    simulation, fleet, network = Simulation(seed=arguments.seed), FleetState(dialect), MemoryNetwork()
    vehicles = add_swarm(simulation) if arguments.swarm else add_vehicles(simulation)
    drone = None if arguments.swarm else add_racing_drone(simulation)
    async with Runner(simulation, speed=arguments.speed) as runner:
        await runner.connect(network.link(), vehicles)
        urls = with_link_options(arguments.out, arguments)
        announce_exposure("demo", [await runner.connect(url, vehicles) for url in urls])
        async with (
            nullcontext() if drone is None else bridged(runner, drone, network),
            # Not the default ids: the user's ground station has them, and answers go to the requester's ids.
            Node(network.link(), dialect=dialect, system=_OWN_SYSTEM) as ground,
            background_tasks(
                _observe(ground, fleet),
                fly_swarm(network, fleet.announce) if arguments.swarm else fly_missions(ground, vehicles),
            ),
            AsyncExitStack() as stack,
        ):
            if arguments.web:
                url = await stack.enter_async_context(station_served(network.link(), arguments.port))
                echo(f"ground station on {url}; Ctrl-C to end")
                arguments.out.append(url)
            await _show(runner, fleet, arguments)
    return 0


async def _observe(ground: Node, fleet: FleetState) -> None:
    from time import monotonic

    async with ground.packets(queue=10_000) as packets:
        async for packet in packets:
            fleet.update(packet, monotonic())


async def _show(runner: Runner, fleet: FleetState, arguments: Namespace) -> None:
    from mavstack.cli.watch.link_follower import background_tasks

    if arguments.once:
        await runner.run(arguments.seconds or (_SWARM_DURATION if arguments.swarm else _SUMMARY_DURATION))
        _print_summary(fleet, arguments)
        return
    if arguments.quiet:
        await runner.run(arguments.seconds)
        return
    from mavstack.cli.demo.fleet_display import FleetDisplay

    title = "six copters as a swarm" if arguments.swarm else "eight simulated vehicles"
    title += f" on {arguments.out[0]}" if arguments.out else ""
    with FleetDisplay(title, fleet) as display:
        async with background_tasks(display.run()):
            await runner.run(arguments.seconds)


def _choose_output(arguments: Namespace) -> None:
    """Choose a summary in a pipe or without rich, and no output in a pipe with `--out` or `--web`."""
    served = bool(arguments.out) or arguments.web
    arguments.quiet = served and not (arguments.once or arguments.json or sys.stdout.isatty())
    arguments.once = not arguments.quiet and (arguments.once or arguments.json or not sys.stdout.isatty())
    if arguments.once or arguments.quiet:
        return
    try:
        import mavstack.cli.demo.fleet_display  # noqa: F401
    except MissingExtraError as error:
        echo(f"mav demo: {error}", error=True)
        arguments.once = True


def _print_summary(fleet: FleetState, arguments: Namespace) -> None:
    vehicles = [_summary(fleet, system) for system in sorted(fleet.vehicles)]
    if arguments.json:
        texts = [{"system": system, "text": text} for _, system, text in fleet.texts]
        echo_json({"vehicles": vehicles, "texts": texts, "parts": fleet.parts})
        return
    if fleet.parts:
        echo(f"flown: {'; '.join(fleet.parts)}")
    echo(f"{'ID':>3}  {'VEHICLE':<28}{'MODE':<12}{'HEIGHT':>9}{'SPEED':>10}  {'BATTERY':>7}  ITEM")
    for each in vehicles:
        height, speed = f"{each['height_m']:.1f} m", f"{each['speed_m_s']:.1f} m/s"
        battery = "" if each["battery"] is None else f"{each['battery']} %"
        item = "" if each["item"] is None else each["item"]
        who = f"{each['system']:>3}  {each['vehicle']:<28}{each['mode']:<12}"
        echo(f"{who}{height:>9}{speed:>10}  {battery:>7}  {item}")


def _summary(fleet: FleetState, system: int) -> dict[str, Any]:
    vehicle = fleet.vehicles[system]
    identity = vehicle.identity
    return {
        "system": system,
        "vehicle": f"{identity.autopilot} {identity.type_name}",
        "mode": identity.mode,
        "armed": identity.armed,
        "latitude": vehicle.latitude,
        "longitude": vehicle.longitude,
        "height_m": vehicle.height,
        "speed_m_s": vehicle.speed,
        "battery": vehicle.battery,
        "item": vehicle.item,
    }
