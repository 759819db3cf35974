"""`mav vehicle check`, `airframe` and `ports`: the check list before a first flight, and the set-up."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import on_vehicle
from mavstack.cli.common.output import align_columns, coloured, echo, echo_json
from mavstack.cli.common.selection import of_vehicle, selects_several
from mavstack.cli.vehicle.arguments import add_action, add_timed
from mavstack.vehicle.setup import (
    first_flight,
    get_airframe,
    get_serial_ports,
    plan_airframe,
    set_airframe,
    set_serial_port,
)
from mavstack.vehicle.setup.json_text import airframe_json, check_json, port_json

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.cli.common.actions import Actions
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.setup import CheckItem, SerialPort

_COLOURS: Final = {"ok": "green", "missing": "red", "advice": "yellow", "unknown": "grey"}


def add_actions(actions: Actions) -> None:
    """Declare the actions."""
    add_action(actions, "check", "show what is missing before a first flight", check)
    action = add_timed(actions, "airframe", "show or change the airframe", airframe, fleet=False)
    action.add_argument("number", nargs="?", type=int, metavar="NUMBER", help="SYS_AUTOSTART or FRAME_CLASS")
    action.add_argument("kind", nargs="?", type=int, metavar="TYPE", help="FRAME_TYPE of ArduPilot")
    action.add_argument("--keep-parameters", action="store_true", help="do not let PX4 reset its parameters")
    action.add_argument("--dry-run", action="store_true", help="show what would change, and change nothing")
    action = add_timed(actions, "ports", "show the serial ports, or set one", ports, fleet=False)
    action.add_argument("port", nargs="?", metavar="PORT", help="the port to set: SERIAL2, TEL1, UART1 …")
    protocol = "protocol of an ArduPilot port, or functions of a Betaflight or iNav port as bits"
    action.add_argument("--protocol", type=int, metavar="NUMBER", help=protocol)
    action.add_argument("--baud", type=int, metavar="N", help="rate in bits per second")


@on_vehicle
async def check(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav vehicle check`; the exit code is 1 if something is missing."""
    items = await first_flight(vehicle)
    if arguments.json:
        echo_json({"system": vehicle.system, "items": [check_json(each) for each in items]})
    else:
        head = [f"vehicle {vehicle.system}:"] if selects_several(arguments) else []
        echo(*head, *_check_lines(items))
    return 1 if any(each.state == "missing" for each in items) else 0


@on_vehicle
async def airframe(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav vehicle airframe`."""
    found = await get_airframe(vehicle)
    if arguments.number is not None:
        reset = not arguments.keep_parameters
        change = plan_airframe(vehicle, arguments.number, arguments.kind, reset=reset)
        if arguments.dry_run:
            echo(of_vehicle(vehicle, f"{change}; nothing was sent"))
            return 0
        found = await set_airframe(vehicle, change)
    if arguments.json:
        echo_json({"system": vehicle.system, **airframe_json(found)})
        return 0
    values = ", ".join(f"{name} {value}" for name, value in found.values.items())
    echo(of_vehicle(vehicle, f"{found.name} ({values})"))
    return 0


@on_vehicle
async def ports(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav vehicle ports`."""
    if arguments.port is None:
        found = await get_serial_ports(vehicle)
    else:
        name = arguments.port.upper()
        found = (await set_serial_port(vehicle, name, arguments.protocol, arguments.baud),)
    if arguments.json:
        echo_json({"system": vehicle.system, "ports": [port_json(each) for each in found]})
    else:
        echo(*_port_lines(found, changed=arguments.port is not None))
    return 0


def _check_lines(items: tuple[CheckItem, ...]) -> list[str]:
    rows = [
        (str(each.state), each.name, each.text + (f": {each.remedy}" if each.remedy else ""))
        for each in items
    ]
    lines = align_columns(rows)
    return [coloured(line, _COLOURS[str(each.state)]) for each, line in zip(items, lines, strict=True)]


def _port_lines(found: tuple[SerialPort, ...], *, changed: bool) -> list[str]:
    lines = align_columns([(each.name, each.protocol, str(each.baud or "")) for each in found])
    return [*lines, "takes effect after a restart"] if changed else lines or ["it has no parameters of ports"]
