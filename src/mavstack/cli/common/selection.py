"""The vehicles that a command acts on: `--system`, `--systems`, `--all`.

A command that changes something must never act on a vehicle by chance. Without a selection it listens for two
heartbeat intervals, and refuses if it hears more than one vehicle. A command that only reads takes the first
vehicle heard and says which one it was.
"""

from __future__ import annotations

import asyncio
from argparse import ArgumentTypeError
from contextlib import nullcontext, suppress
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import system_id
from mavstack.cli.common.output import echo
from mavstack.errors import SystemIdConflictError
from mavstack.vehicle import Group, VehicleFound

if TYPE_CHECKING:
    from argparse import Namespace, _ArgumentGroup
    from collections.abc import Iterable, Mapping

    from mavstack.vehicle import Connection, Vehicle

#: Seconds to wait for further vehicles after the first was found: the time of two heartbeats.
DISCOVERY_TIME: Final = 2.5
_MAX_SYSTEM = 255
#: Name of the operation of each command in the error that refuses it while several vehicles use one id.
_OPERATIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "param": "changing parameters of",
        "mission": "changing the mission of",
        "ftp": "changing files of",
        "log": "erasing logs of",
        "terrain": "changing the terrain of",
        "gimbal": "moving the gimbal of",
        "camera": "using the camera of",
        "rate": "setting message rates of",
        "key": "changing the signing key of",
    }
)


def add_system_option(group: _ArgumentGroup, *, fleet: bool, changes: bool) -> None:
    """Declare `--system`, and with `fleet` also `--systems` and `--all`, which exclude each other."""
    default = "needed if more than one vehicle is heard" if changes else "default: the first vehicle heard"
    exclusive = group.add_mutually_exclusive_group()
    exclusive.add_argument("--system", type=system_id, metavar="ID", help=f"system id ({default})")
    if fleet:
        exclusive.add_argument(
            "--systems", type=system_ids, metavar="IDS", help="several vehicles by system id: 1,2,5-9"
        )
        exclusive.add_argument("--all", action="store_true", help="all vehicles that are heard")


def system_ids(text: str) -> list[int]:
    """Parse system ids such as 1,2,5-9, for argparse."""
    found: dict[int, None] = {}
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        if not (_is_id(first) and (not dash or _is_id(last))):
            raise ArgumentTypeError(f"{text!r} is not a list of system ids such as 1,2,5-9")
        found.update(dict.fromkeys(range(int(first), int(last or first) + 1)))
    if not found:
        raise ArgumentTypeError(f"{text!r} is an empty range")
    return list(found)


def selects_several(arguments: Namespace) -> bool:
    """Return whether several vehicles are selected."""
    return bool(getattr(arguments, "all", False) or getattr(arguments, "systems", None))


async def selected_vehicles(connection: Connection, arguments: Namespace) -> Group:
    """Wait for the selected vehicles.

    Raises:
        RemoteTimeout: A vehicle is not heard in time.
        UsageError: The command changes something, several vehicles are heard, and none is selected.
        SystemIdConflictError: The command changes something, and several vehicles use one system id.
    """
    group = await _selected(connection, arguments)
    if getattr(arguments, "changes", False):
        operation = _OPERATIONS.get(arguments.command)
        # The API itself refuses the actions of `mav vehicle`, before they have an effect.
        with suppress(SystemIdConflictError) if arguments.command == "vehicle" else nullcontext():
            for vehicle in group:
                await connection.check_sender(vehicle.system, operation or "acting on")
    return group


async def _selected(connection: Connection, arguments: Namespace) -> Group:
    timeout = arguments.timeout
    if getattr(arguments, "systems", None):
        waiting = [connection.wait_for_vehicle(system, timeout=timeout) for system in arguments.systems]
        return Group(await asyncio.gather(*waiting))
    first = await connection.wait_for_vehicle(arguments.system, timeout=timeout)
    if getattr(arguments, "all", False):
        return await _all_vehicles(connection)
    if arguments.system is None and getattr(arguments, "changes", False):
        await require_one_vehicle(connection, _remedy(arguments))
    return Group([first])


async def several_vehicles(connection: Connection) -> bool:
    """Listen for further vehicles, and return whether more than one is heard."""
    async with connection.events(VehicleFound) as found:
        with suppress(TimeoutError):
            async with asyncio.timeout(DISCOVERY_TIME):
                while len(connection.vehicles) < 2:
                    await anext(found)
    return len(connection.vehicles) > 1


async def require_one_vehicle(connection: Connection, remedy: str) -> None:
    """Listen for other vehicles.

    Raises:
        UsageError: More than one vehicle is heard; the text ends with the remedy.
    """
    if await several_vehicles(connection):
        heard = systems_text(connection.vehicles)
        raise UsageError(f"more than one vehicle is heard ({heard}); {remedy}")


def mention_other_vehicles(connection: Connection, vehicle: Vehicle, arguments: Namespace) -> None:
    """Say on stderr which vehicle was used, if none was selected and several are heard."""
    others = [system for system in connection.vehicles if system != vehicle.system]
    if others and arguments.system is None:
        text = f"this is vehicle {vehicle.system}; also heard: {systems_text(others)} (--system ID selects)"
        echo(f"mav {arguments.command}: {text}", error=True)


async def mention_conflict(vehicle: Vehicle, arguments: Namespace) -> None:
    """Say on stderr that several vehicles use the system id, so that what was read is of either."""
    with suppress(SystemIdConflictError):
        await vehicle.connection.check_sender(vehicle.system)
    conflict = vehicle.id_conflict
    if conflict is not None and vehicle.chosen_sender is None:
        text = f"{len(conflict.senders)} vehicles use system id {vehicle.system}: {conflict}"
        echo(f"mav {arguments.command}: {text} (--channel selects one)", error=True)


def systems_text(systems: Iterable[int]) -> str:
    """Return system ids as a text: 1, 2, 5."""
    return ", ".join(map(str, sorted(systems)))


def of_vehicle(vehicle: Vehicle, text: str) -> str:
    """Return the outcome of a vehicle as a line that names the vehicle."""
    return f"vehicle {vehicle.system}: {text}"


async def _all_vehicles(connection: Connection) -> Group:
    known = 0
    while len(connection.vehicles) > known:
        known = len(connection.vehicles)
        await asyncio.sleep(DISCOVERY_TIME)
    return Group(sorted(connection.vehicles.values(), key=lambda vehicle: vehicle.system))


def _remedy(arguments: Namespace) -> str:
    several = ", or several with --systems IDS or --all" if hasattr(arguments, "systems") else ""
    return f"select one with --system ID{several}"


def _is_id(text: str) -> bool:
    return text.isascii() and text.isdecimal() and 0 < int(text) <= _MAX_SYSTEM
