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
    action = add_timed(actions, "transponder", "show or set the ADS-B transponder", transponder)
    add = action.add_argument
    add("squawk", nargs="?", metavar="SQUAWK", help="Mode A code, four digits from 0 to 7; without it: show")
    add("--flight-id", metavar="ID", help="flight identification (default with a squawk: none)")
    add("--standby", action="store_true", help="do not reply, and send no position")
    add("--no-altitude", dest="altitude", action="store_false", help="do not report the altitude (Mode C)")
    add("--ident", action="store_true", help="identify the vehicle to a controller, for some seconds")
    add("--registration", metavar="TEXT", help="of the aircraft, in a transponder that speaks MAVLink itself")
    add("--identity", action="store_true", help="show registration and flight id of such a transponder")


@on_vehicles
async def transponder(vehicle: Vehicle, arguments: Namespace) -> str:
    """Run `mav vehicle transponder`."""
    timeout = arguments.action_timeout or DEFAULT_TIMEOUT
    _check(arguments)
    try:
        if arguments.identity or arguments.registration is not None:
            await _set_identity(vehicle, arguments, timeout)
            return await _identity(vehicle, timeout)
        if arguments.squawk is None:
            return describe(await vehicle.transponder.get(timeout=timeout))
        return describe(await _set(vehicle, arguments, timeout))
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None


def _check(arguments: Namespace) -> None:
    """Raise if options do not belong together."""
    states = arguments.standby or arguments.ident or not arguments.altitude
    if arguments.identity or arguments.registration is not None:
        if arguments.squawk is not None or states:
            reason = "a transponder that speaks MAVLink itself takes registration and flight id alone"
            raise UsageError(f"{reason}: leave out squawk, --standby, --no-altitude and --ident")
    elif arguments.squawk is None and (arguments.flight_id or states):
        raise UsageError("a setting needs a squawk, since all settings are sent at the same time")


async def _set(vehicle: Vehicle, arguments: Namespace, limit: float) -> TransponderStatus:
    return await vehicle.transponder.set(
        squawk=arguments.squawk,
        flight_id=arguments.flight_id or "",
        transmits=not arguments.standby,
        altitude=arguments.altitude,
        ident=arguments.ident,
        timeout=limit,
    )


async def _set_identity(vehicle: Vehicle, arguments: Namespace, limit: float) -> None:
    if arguments.registration is not None:
        await vehicle.transponder.set_registration(arguments.registration, timeout=limit)
    if arguments.flight_id is not None:
        await vehicle.transponder.set_flight_id(arguments.flight_id, timeout=limit)


async def _identity(vehicle: Vehicle, limit: float) -> str:
    registration = await vehicle.transponder.get_registration(timeout=limit)
    flight_id = await vehicle.transponder.get_flight_id(timeout=limit)
    return f"registration {registration or 'not set'}, flight id {flight_id or 'not set'}"


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
