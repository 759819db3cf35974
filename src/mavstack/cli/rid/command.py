"""`mav rid`: whether Remote ID lets a vehicle arm, and the messages of its operator."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_vehicle_action, on_vehicle, run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.errors import InvalidArgumentError
from mavstack.services.remote_id import Operator, RemoteIdMonitor, RemoteIdSender

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.services.remote_id import RemoteIdStatus
    from mavstack.vehicle import Vehicle

EXAMPLES: Final = """\
examples:
  mav rid status --url udpin://0.0.0.0:14550        # may it arm, and why not; exit code 1 if not
  mav rid status --json
  mav rid send --operator 47.3977,8.5456,488 --operator-id FIN87astrdge12k8
  mav rid send --operator 47.3977,8.5456 --serial 1596F3A0B1C2D3E4 --for 60
"""

#: Seconds for which messages are received: each kind is sent once a second.
_LISTENING: Final = 4.0


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "rid", EXAMPLES)
    action = add_vehicle_action(actions, "status", "show whether Remote ID lets a vehicle arm", status)
    action.add_argument(
        "--for", dest="duration", type=seconds, default=_LISTENING, metavar="SECONDS",
        help=f"listen this long (default: {_LISTENING:g})",
    )  # fmt: skip
    action = add_vehicle_action(actions, "send", "send the messages of the operator, until Ctrl-C", send)
    action.add_argument(
        "--operator", type=_position, required=True, metavar="LAT,LON[,ALT]",
        help="the position of the operator: degrees, and metres above the ellipsoid",
    )  # fmt: skip
    action.add_argument("--operator-id", default="", metavar="ID", help="registration of the operator")
    action.add_argument("--serial", default="", metavar="ID", help="serial number of the vehicle")
    action.add_argument("--description", default="", metavar="TEXT", help="purpose of the flight")
    action.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")


@on_vehicle
async def status(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav rid status`."""
    connection = vehicle.connection
    monitor = connection.serve(RemoteIdMonitor(connection.address, vehicle.system))
    await asyncio.sleep(arguments.duration)
    found = monitor.status(connection.now())
    if arguments.json:
        echo_json({"system": vehicle.system} | asdict(found))
    else:
        echo(*_lines(found))
    return 0 if found.may_arm else 1


def send(arguments: Namespace) -> int:
    """Run `mav rid send`."""
    try:
        operator = Operator(
            **arguments.operator,
            operator_id=arguments.operator_id,
            uas_id=arguments.serial,
            description=arguments.description,
        )
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None

    async def work(vehicle: Vehicle) -> int:
        connection = vehicle.connection
        sender = connection.serve(
            RemoteIdSender(connection.address, vehicle.system, operator, connection.now())
        )
        if not arguments.json:
            echo(f"sending the messages of the operator to {vehicle.address}")
        try:
            await asyncio.wait_for(connection.serve_forever(), arguments.duration)
        except TimeoutError:
            return 0
        finally:
            if arguments.json:
                echo_json({"system": vehicle.system, "sent": sender.sent})
        return 0

    return run_on_vehicle(arguments, work)


def _lines(found: RemoteIdStatus) -> list[str]:
    verdict = {True: "may arm", False: "may not arm", None: "is not known to be ready"}[found.may_arm]
    lines = [f"the vehicle {verdict} (module {found.module or 'none'})"]
    lines += [f"  {reason}" for reason in found.reasons]
    lines += [f"vehicle id {found.uas_id}"] * bool(found.uas_id)
    lines += [f"operator id {found.operator_id}"] * bool(found.operator_id)
    if found.operator is not None:
        lines.append(f"operator at {found.operator[0]:.7f}, {found.operator[1]:.7f}")
    if found.location is not None:
        lines.append(f"vehicle at {found.location[0]:.7f}, {found.location[1]:.7f}")
    return lines


def _position(text: str) -> dict[str, float]:
    numbers = [float(word) for word in text.split(",")]
    if len(numbers) not in (2, 3):
        raise ValueError(text)
    return dict(zip(("latitude", "longitude", "altitude"), numbers, strict=False))
