"""`mav simulator`: the world in which real firmware flies, by one's own physics.

It prints a line when it is ready, one when the firmware is connected, and runs until Ctrl-C or until the
program that it started ends.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.sim.arguments import home
from mavstack.cli.simulator.foreign import add_vehicle_arguments
from mavstack.cli.simulator.running import fly_firmware, fly_hardware
from mavstack.simulators.ardupilot_simulator import ARDUPILOT_PORT
from mavstack.simulators.betaflight import BRIDGES, MOTOR_ORDERS
from mavstack.simulators.betaflight_simulator import BETAFLIGHT_PORT
from mavstack.simulators.faults import FAULTS
from mavstack.simulators.firmware_command import VEHICLES
from mavstack.simulators.physics import PHYSICS
from mavstack.simulators.px4_simulator import PX4_PORT
from mavstack.simulators.sensors import EQUIPMENT

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

EXAMPLES: Final = """\
examples:
  mav simulator px4                                     # a quadrotor; PX4 connects to TCP port 4560
  mav simulator px4 --physics copter --speed 0          # as fast as PX4 answers
  mav simulator px4 --binary build/px4_sitl_default/bin/px4 --web      # starts PX4 and the ground station
  mav simulator px4 --binary build/px4_sitl_default/bin/px4 --physics jsbsim:c172x   # a plane
  mav simulator ardupilot --physics rover               # SITL: --model JSON:127.0.0.1
  mav simulator ardupilot --physics jsbsim:c172x        # a Cessna of JSBSim
  mav simulator ardupilot --binary build/sitl/bin/arduplane --vehicle plane
  mav simulator ardupilot --physics balloon:Balloon     # your own class, in balloon.py
  mav simulator ardupilot --fault gps-lost --fault imu-biased
  mav simulator betaflight --binary obj/main/betaflight_SITL.elf
  mav simulator hardware /dev/ttyACM0,921600            # a board with PX4 and SYS_HITL 1
  mav simulator vehicle px4 --to tcpout://127.0.0.1:4560  # a vehicle of Mavstack in another simulator
  mav simulator list                                    # the kinds of physics, and the faults
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "simulator", EXAMPLES)
    action = actions.add("px4", "simulate the world of a PX4, in lockstep over TCP", fly_firmware)
    _add_firmware(action, "px4", "PX4", f"tcpin://127.0.0.1:{PX4_PORT}")
    action.add_argument("--model", metavar="NAME", help="PX4's model (default: by vehicle, as none_iris)")
    _add_parameter(action, "a parameter of each start of --binary; may be repeated")
    action = actions.add(
        "ardupilot", "simulate the world of an ArduPilot, by its JSON interface", fly_firmware
    )
    _add_firmware(action, "ardupilot", "ArduPilot", f"udpin://127.0.0.1:{ARDUPILOT_PORT}")
    action.add_argument(
        "--out",
        action="append",
        default=[],
        metavar="URL",
        help="where to offer the vehicle of --binary; may be repeated (default: udpout://127.0.0.1:14550)",
    )
    _add_parameter(action, "a parameter of the first start of --binary; may be repeated")
    action = actions.add("betaflight", "simulate the world of a Betaflight, by its UDP packets", fly_firmware)
    _add_firmware(action, "betaflight", "Betaflight", f"udpin://127.0.0.1:{BETAFLIGHT_PORT}")
    action.add_argument(
        "--bridge", choices=BRIDGES, default="gazebo", help="what the build expects (default: gazebo)"
    )
    action.add_argument(
        "--motors",
        choices=MOTOR_ORDERS,
        default="betaflight",
        help="the order of its motors; gazebo before 2026 (default: betaflight)",
    )
    action = actions.add("hardware", "simulate the world of a board: hardware in the loop", fly_hardware)
    action.add_argument("link", metavar="URL", help="link to the board, such as /dev/ttyACM0,921600")
    action.add_argument("--firmware", choices=("px4", "ardupilot"), default="px4", help="default: px4")
    _add_world(action, "copter")
    add_vehicle_arguments(actions)
    action = actions.add("list", "list the kinds of physics and the faults", show)
    action.add_argument("--json", action="store_true", help="print JSON")


def _add_parameter(action: ArgumentParser, description: str) -> None:
    action.add_argument("--parameter", action="append", default=[], metavar="NAME=VALUE", help=description)


def _add_firmware(action: ArgumentParser, firmware: str, name: str, listen: str) -> None:
    """Add what all firmwares of this machine have."""
    add = action.add_argument
    add("--listen", metavar="URL", help=f"where {name} connects (default: {listen})")
    add("--binary", metavar="PROGRAM", help=f"start this {name}; without it, start one yourself")
    add(
        "--vehicle",
        choices=VEHICLES,
        help="the vehicle, for body, model and parameters (default: by --physics, or copter)",
    )
    add(
        "--speed",
        type=float,
        default=1.0,
        metavar="FACTOR",
        help="simulated seconds in a real second; 0: as fast as possible (default: 1)",
    )
    add("--folder", type=Path, metavar="DIRECTORY", help="folder of --binary (default: a temporary one)")
    if firmware != "betaflight":
        add("--instances", type=int, default=1, metavar="N", help="vehicles at once (default: 1)")
        add(
            "--equipment",
            action="append",
            default=[],
            choices=EQUIPMENT,
            help="a sensor beside the usual ones; may be repeated",
        )
    add("--web", action="store_true", help="serve the ground station too, with the vehicle of --binary")
    action.set_defaults(firmware=firmware)
    _add_world(action, None)


def _add_world(action: ArgumentParser, physics: str | None) -> None:
    add = action.add_argument
    add(
        "--physics",
        default=physics,
        metavar="NAME",
        help=f"{', '.join(PHYSICS)} with :MODEL, or module:Class of your own (default: by vehicle)",
    )
    add(
        "--home",
        type=home,
        metavar="LAT,LON,ALT,HDG",
        help="the place at the start: degrees, metres above sea, heading in degrees (default: by vehicle)",
    )
    add("--seed", type=int, default=1, metavar="N", help="seed of the sensors' noise (default: 1)")
    add(
        "--fault",
        action="append",
        default=[],
        metavar="NAME[@BEGIN[+SECONDS]]",
        help=f"a fault of the sensors, from a simulated second on: {', '.join(FAULTS)}; may be repeated",
    )
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after this real time")
    add("--until", type=seconds, metavar="SECONDS", help="end after this simulated time")
    add("--json", action="store_true", help="print JSON")


def show(arguments: Namespace) -> int:
    """Run `mav simulator list`."""
    if arguments.json:
        echo_json(
            {
                "physics": {
                    name: {"about": each.about, "example": each.example} for name, each in PHYSICS.items()
                },
                "faults": FAULTS,
                "equipment": EQUIPMENT,
            }
        )
        return 0
    rows = [(each.example, each.about) for each in PHYSICS.values()]
    rows.append(("module:Class", "a class of your own with reset(home, heading) and step(actuators, dt)"))
    echo("physics:", *("  " + line for line in align_columns(rows)))
    echo("faults:", *("  " + line for line in align_columns(list(FAULTS.items()))))
    return 0
