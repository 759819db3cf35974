"""`mav vehicle transponder`: the ADS-B transponder of a vehicle, shown or set."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.cli.vehicle.arguments import add_timed
from mavstack.cli.vehicle.outcomes import on_vehicles
from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.transponder import DEFAULT_TIMEOUT

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.cli.common.actions import Actions
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.transponder import TransponderStatus


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    action = add_timed(actions, "transponder", "show or set the ADS-B transponder (ArduPilot)", transponder)
    add = action.add_argument
    add("squawk", nargs="?", metavar="SQUAWK", help="Mode A code, four digits from 0 to 7; without it: show")
    add("--flight-id", default="", metavar="ID", help="flight identification (default: none)")
    add("--standby", action="store_true", help="do not reply, and send no position")
    add("--no-altitude", dest="altitude", action="store_false", help="do not report the altitude (Mode C)")
    add("--ident", action="store_true", help="identify the vehicle to a controller, for some seconds")


@on_vehicles
async def transponder(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle transponder`."""
    timeout = arguments.action_timeout or DEFAULT_TIMEOUT
    if arguments.squawk is None:
        if arguments.flight_id or arguments.standby or arguments.ident or not arguments.altitude:
            raise UsageError("a setting needs a squawk, since all settings are sent at the same time")
        return describe(await vehicle.transponder.get(timeout=timeout))
    try:
        status = await vehicle.transponder.set(
            squawk=arguments.squawk,
            flight_id=arguments.flight_id,
            transmits=not arguments.standby,
            altitude=arguments.altitude,
            ident=arguments.ident,
            timeout=timeout,
        )
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None
    return describe(status)


def describe(status: TransponderStatus) -> str:
    """Return the state of a transponder in one line."""
    parts = [f"squawk {status.squawk}"]
    parts += [f"flight id {status.flight_id}"] * bool(status.flight_id)
    parts.append("transmits" if status.transmits else "standby")
    parts += ["without altitude"] * (status.transmits and not status.altitude)
    parts += ["ident"] * status.ident
    parts += ["on the ground"] * status.on_ground
    parts += [f"faults: {' '.join(status.faults)}"] * bool(status.faults)
    return ", ".join(parts)
