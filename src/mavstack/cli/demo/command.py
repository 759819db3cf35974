"""`mav demo`: a simulated fleet that flies missions, and its live picture, all on this machine."""

from __future__ import annotations

import asyncio
import json
import sys
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.options import seconds
from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.cli.demo.fleet_state import FleetWatch
    from mavstack.node import Node
    from mavstack.sim.runner import Runner

EXAMPLES: Final = """\
examples:
  mav demo                     seven vehicles on missions, live, until Ctrl-C
  mav demo --speed 5           five times as fast
  mav demo --for 60 --once     a minute of it in fast motion, then where everybody is
  mav demo --once --json       the same as one JSON object

While it runs with --out udpout://127.0.0.1:14550, in another terminal or any ground station:
  mav watch udpin://127.0.0.1:14550
"""

_SUMMARY_OF: Final = 60.0


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    add = parser.add_argument
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after so many simulated seconds")
    add("--speed", type=seconds, default=1.0, metavar="N", help="simulated seconds in a second (default: 1)")
    add("--once", action="store_true", help="as fast as it goes, then a summary, no live picture")
    add("--json", action="store_true", help="the summary as one JSON object")
    add(
        "--out",
        action="append",
        default=[],
        metavar="URL",
        help="let others see and fly them too, on this link",
    )
    add("--seed", type=int, default=1, metavar="N", help="of everything random (default: 1)")


def run(arguments: Namespace) -> int:
    """Fly."""
    _prefer_summary(arguments)
    if arguments.once and not arguments.out:
        from mavstack.sim.virtual import run_virtually

        return run_virtually(_demo(arguments))
    return asyncio.run(_demo(arguments))


async def _demo(arguments: Namespace) -> int:
    from mavstack.cli.demo.fleet_state import FleetWatch
    from mavstack.cli.demo.flights import direct, populate
    from mavstack.cli.watch.follower import beside
    from mavstack.dialects import Dialect
    from mavstack.links import MemoryNetwork
    from mavstack.node import Node
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation

    dialect = Dialect.load("all")
    simulation, watch, network = Simulation(seed=arguments.seed), FleetWatch(dialect), MemoryNetwork()
    vehicles = populate(simulation)
    async with Runner(simulation, speed=arguments.speed) as runner:
        await runner.connect(network.link(), vehicles)
        for url in arguments.out:
            await runner.connect(url, vehicles)
        async with (
            Node(network.link(), dialect=dialect) as ground,
            beside(_observe(ground, watch), direct(ground, vehicles)),
        ):
            await _show(runner, watch, arguments)
    return 0


async def _observe(ground: Node, watch: FleetWatch) -> None:
    from time import monotonic

    async with ground.packets(queue=10_000) as packets:
        async for packet in packets:
            watch.take(packet, monotonic())


async def _show(runner: Runner, watch: FleetWatch, arguments: Namespace) -> None:
    from mavstack.cli.watch.follower import beside

    if arguments.once:
        await runner.run(arguments.seconds or _SUMMARY_OF)
        _print_summary(watch, arguments)
        return
    if arguments.quiet:
        await runner.run(arguments.seconds)
        return
    from mavstack.cli.demo.fleet_display import FleetPicture

    shown = f"seven simulated vehicles{f' on {arguments.out[0]}' if arguments.out else ''}"
    with FleetPicture(shown, watch) as picture:
        async with beside(picture.run()):
            await runner.run(arguments.seconds)


def _prefer_summary(arguments: Namespace) -> None:
    """In a pipe, or without the library that draws, a summary; with `--out`, where others look, nothing."""
    arguments.quiet = bool(arguments.out) and not (arguments.once or arguments.json or sys.stdout.isatty())
    arguments.once = not arguments.quiet and (arguments.once or arguments.json or not sys.stdout.isatty())
    if arguments.once or arguments.quiet:
        return
    try:
        import mavstack.cli.demo.fleet_display  # noqa: F401
    except MissingExtraError as error:
        print(f"mav demo: {error}", file=sys.stderr)
        arguments.once = True


def _print_summary(watch: FleetWatch, arguments: Namespace) -> None:
    vehicles = [_summary(watch, system) for system in sorted(watch.vehicles)]
    if arguments.json:
        texts = [{"system": system, "text": text} for _, system, text in watch.texts]
        print(json.dumps({"vehicles": vehicles, "texts": texts}))
        return
    print(f"{'ID':>3}  {'VEHICLE':<28}{'MODE':<14}{'HEIGHT':>9}{'SPEED':>10}  {'BATTERY':>7}  ITEM")
    for each in vehicles:
        height, speed = f"{each['height_m']:.1f} m", f"{each['speed_m_s']:.1f} m/s"
        battery = "" if each["battery"] is None else f"{each['battery']} %"
        item = "" if each["item"] is None else each["item"]
        who = f"{each['system']:>3}  {each['vehicle']:<28}{each['mode']:<14}"
        print(f"{who}{height:>9}{speed:>10}  {battery:>7}  {item}")


def _summary(watch: FleetWatch, system: int) -> dict[str, Any]:
    seen = watch.vehicles[system]
    identity = seen.identity
    return {
        "system": system,
        "vehicle": f"{identity.autopilot} {identity.type_name}",
        "mode": identity.mode,
        "armed": identity.armed,
        "latitude": seen.latitude,
        "longitude": seen.longitude,
        "height_m": seen.height,
        "speed_m_s": seen.speed,
        "battery": seen.battery,
        "item": seen.item,
    }
