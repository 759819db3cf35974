"""`mav simulator`: the world in which real PX4 or ArduPilot flies, by one's own physics.

It prints a line when it is ready, one when the firmware is connected, and runs until Ctrl-C.
"""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.sim.arguments import home
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.physics import PHYSICS
from mavstack.simulators.sensors import FAULTS
from mavstack.simulators.simulator import ARDUPILOT_PORT, PX4_PORT, ArduPilotSimulator, Px4Simulator

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

EXAMPLES: Final = """\
examples:
  mav simulator px4                                     # a quadrotor; PX4 connects to TCP port 4560
  mav simulator px4 --physics copter --speed 0          # as fast as PX4 answers
  mav simulator ardupilot --physics rover               # SITL: --model JSON:127.0.0.1
  mav simulator ardupilot --physics jsbsim:c172x        # a Cessna of JSBSim
  mav simulator ardupilot --physics balloon:Balloon     # your own class, in balloon.py
  mav simulator ardupilot --fault gps-lost --fault imu-biased
  mav simulator list                                    # the kinds of physics, and the faults
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "simulator", EXAMPLES)
    action = actions.add("px4", "simulate the world of a PX4, in lockstep over TCP", px4)
    action.add_argument(
        "--listen", default=f"tcpin://127.0.0.1:{PX4_PORT}", metavar="URL", help=_listen("PX4")
    )
    action.add_argument(
        "--speed",
        type=float,
        default=1.0,
        metavar="FACTOR",
        help="simulated seconds in a real second; 0: as fast as PX4 answers (default: 1)",
    )
    _add_world(action)
    action = actions.add("ardupilot", "simulate the world of an ArduPilot, by its JSON interface", ardupilot)
    action.add_argument(
        "--listen", default=f"udpin://127.0.0.1:{ARDUPILOT_PORT}", metavar="URL", help=_listen("ArduPilot")
    )
    _add_world(action)
    action = actions.add("list", "list the kinds of physics and the faults", show)
    action.add_argument("--json", action="store_true", help="print JSON")


def _listen(firmware: str) -> str:
    return f"where {firmware} connects (default: %(default)s)"


def _add_world(action: ArgumentParser) -> None:
    add = action.add_argument
    add(
        "--physics",
        default="copter",
        metavar="NAME",
        help=f"{', '.join(PHYSICS)} with :MODEL, or module:Class of your own (default: copter)",
    )
    add(
        "--home",
        type=home,
        default=DEFAULT_HOME,
        metavar="LAT,LON,ALT,HDG",
        help="the place at the start: degrees, metres above sea, heading in degrees",
    )
    add("--seed", type=int, default=1, metavar="N", help="seed of the sensors' noise (default: 1)")
    add(
        "--fault",
        action="append",
        default=[],
        choices=tuple(FAULTS),
        metavar="NAME",
        help=f"a fault of the sensors from the start: {', '.join(FAULTS)}; may be repeated",
    )
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after this time")
    add("--json", action="store_true", help="print JSON")


def run(arguments: Namespace) -> int:
    """Run the chosen action."""
    code: int = arguments.run_action(arguments)
    return code


def px4(arguments: Namespace) -> int:
    """Run `mav simulator px4`."""
    return asyncio.run(_px4(arguments))


def ardupilot(arguments: Namespace) -> int:
    """Run `mav simulator ardupilot`."""
    return asyncio.run(_ardupilot(arguments))


def show(arguments: Namespace) -> int:
    """Run `mav simulator list`."""
    if arguments.json:
        echo_json(
            {
                "physics": {
                    name: {"about": each.about, "example": each.example} for name, each in PHYSICS.items()
                },
                "faults": FAULTS,
            }
        )
        return 0
    rows = [(each.example, each.about) for each in PHYSICS.values()]
    rows.append(("module:Class", "a class of your own with reset(home, heading) and step(actuators, dt)"))
    echo("physics:", *("  " + line for line in align_columns(rows)))
    echo("faults:", *("  " + line for line in align_columns(list(FAULTS.items()))))
    return 0


async def _px4(arguments: Namespace) -> int:
    report = _Reporter(arguments)
    simulator = Px4Simulator(
        arguments.physics,
        home=arguments.home,
        listen=arguments.listen,
        speed=arguments.speed,
        seed=arguments.seed,
        on_connect=report.connected,
    )
    async with simulator:
        report.ready(simulator, f"ready: PX4 connects to TCP port {simulator.port}")
        begun = time.monotonic()
        try:
            async with asyncio.timeout(arguments.seconds):
                await simulator.run()
        except TimeoutError:
            return 0
        report.ended(simulator, time.monotonic() - begun)
    return 1


async def _ardupilot(arguments: Namespace) -> int:
    report = _Reporter(arguments)
    simulator = ArduPilotSimulator(
        arguments.physics,
        home=arguments.home,
        listen=arguments.listen,
        seed=arguments.seed,
        on_connect=report.connected,
    )
    async with simulator:
        report.ready(simulator, f"ready: ArduPilot asks UDP port {simulator.port}")
        try:
            async with asyncio.timeout(arguments.seconds):
                await simulator.run()
        except TimeoutError:
            return 0
    return 0


class _Reporter:
    """Prints what happens, as lines or as JSON."""

    def __init__(self, arguments: Namespace) -> None:
        self._arguments = arguments

    def ready(self, simulator: Px4Simulator | ArduPilotSimulator, line: str) -> None:
        for fault in self._arguments.fault:
            simulator.sensors.set_fault(fault)
        self._print({"event": "ready", "port": simulator.port, "physics": self._arguments.physics}, line)

    def connected(self, line: str) -> None:
        self._print({"event": "connected", "text": line}, line)

    def ended(self, simulator: Px4Simulator, wall: float) -> None:
        line = f"PX4 disconnected after {simulator.time:.1f} s of simulation, {wall:.1f} s of time"
        self._print({"event": "disconnected", "time": simulator.time, "text": line}, line)

    def _print(self, values: dict[str, object], line: str) -> None:
        if self._arguments.json:
            echo_json(values)
        else:
            echo(line)
