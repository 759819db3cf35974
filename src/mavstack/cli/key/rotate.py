"""`mav key rotate`: another key for all vehicles of a key, one vehicle after the other.

The new key is stored before a vehicle gets it, and takes the name of the old one only when every selected
vehicle was confirmed with it (see `mavstack.security.rotation`). Each vehicle has a connection of its own
with the old key, since vehicles that share a channel change one after the other. A vehicle that fails keeps
a key that is stored here, and the same command continues later.
"""

from __future__ import annotations

import asyncio
from argparse import Namespace
from contextlib import suppress
from enum import Enum
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import run_on_connection
from mavstack.cli.common.errors import CommandError, UsageError, failure_text
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import selected_vehicles, systems_text
from mavstack.cli.key.vehicle_key import require_disarmed
from mavstack.errors import MavstackError, RemoteTimeout
from mavstack.links.registry import resolve_url
from mavstack.security.key_store import KEY_SUFFIX, find_stored
from mavstack.security.rotation import Rotation, begin_rotation
from mavstack.services.signing_setup.key_change import signed_with

if TYPE_CHECKING:
    from mavstack.vehicle import Connection, Vehicle

#: Seconds to wait for packets that show the key of a vehicle: the time of three heartbeats.
_PACKET_TIMEOUT: Final = 3.5
#: Number of packets of a vehicle that are checked: a damaged packet shows no key.
_MAX_PACKETS: Final = 20
#: Only the key of a packet matters here, not its age: a vehicle may have no clock.
_NO_CLOCK: Final = 0.0


class _Present(Enum):
    """The key that a vehicle signs with."""

    OLD = "old"
    NEW = "new"
    NONE = "it has no key; mav key install gives it one"
    OTHER = "it signs with another key; mav key list shows which you have"


def rotate(arguments: Namespace) -> int:
    """Run `mav key rotate`."""
    for url in arguments.url:
        if "signing_key" in resolve_url(url).options:
            raise UsageError("the present key is the one that is rotated: leave signing_key out of the URL")
    rotation = begin_rotation(arguments.name)
    if not arguments.json:
        verb = "continues" if rotation.resumed else "begins"
        echo(f"the rotation {verb}; until it ends, the new key is {rotation.next_name}")
    present = _find_present_keys(arguments, rotation)
    problems = {system: _change(arguments, rotation, system, key) for system, key in present.items()}
    failed = {system: text for system, text in problems.items() if text is not None}
    if not failed:
        rotation.finish()
    _report(arguments, rotation, list(present), failed)
    return 1 if failed else 0


def _find_present_keys(arguments: Namespace, rotation: Rotation) -> dict[int, _Present]:
    """Return the present key of each selected vehicle."""
    present: dict[int, _Present] = {}

    async def listen(connection: Connection) -> int:
        for vehicle in await selected_vehicles(connection, arguments):
            present[vehicle.system] = await _present_key(vehicle, rotation)
        return 0

    run_on_connection(_with_key(arguments, None), listen)
    return present


async def _present_key(vehicle: Vehicle, rotation: Rotation) -> _Present:
    found = _Present.NONE
    async with vehicle.connection.packets(system=vehicle.system) as packets:
        with suppress(TimeoutError):
            async with asyncio.timeout(_PACKET_TIMEOUT):
                for _ in range(_MAX_PACKETS):
                    packet = await anext(packets)
                    if signed_with(packet, rotation.new, _NO_CLOCK):
                        return _Present.NEW
                    if signed_with(packet, rotation.old, _NO_CLOCK):
                        return _Present.OLD
                    if packet.signed:
                        found = _Present.OTHER
    return found


def _change(arguments: Namespace, rotation: Rotation, system: int, present: _Present) -> str | None:
    """Change the key of one vehicle; return the reason if it was not confirmed with the new key."""
    if present not in (_Present.OLD, _Present.NEW):
        return str(present.value)

    async def change(connection: Connection) -> int:
        vehicle = await connection.wait_for_vehicle(system, timeout=arguments.timeout)
        if present is _Present.OLD:
            require_disarmed(vehicle)
            await vehicle.component.setup_signing(rotation.new, timeout=arguments.action_timeout)
        return 0

    key = rotation.name if present is _Present.OLD else rotation.next_name
    try:
        run_on_connection(_with_key(arguments, key), change, announce=False)
    except KeyboardInterrupt:
        names = f"{rotation.next_name} or {rotation.name}"
        echo(f"interrupted: vehicle {system} uses {names}; the same command continues", error=True)
        raise
    except RemoteTimeout as error:
        return f"{failure_text(error)}; it may have taken the new key, which the same command finds out"
    except CommandError as error:
        return failure_text(error).removeprefix(f"vehicle {system}: ")
    except (MavstackError, OSError) as error:
        return failure_text(error)
    if not arguments.json:
        echo(f"vehicle {system}: signs and verifies with the new key")
    return None


def _with_key(arguments: Namespace, name: str | None) -> Namespace:
    """Return the arguments with a key of the user's key directory for all links."""
    path = None if name is None else find_stored(name)
    key = str(path) if path is not None and path.suffix == KEY_SUFFIX else name
    return Namespace(**{**vars(arguments), "signing_key": key})


def _report(arguments: Namespace, rotation: Rotation, systems: list[int], failed: dict[int, str]) -> None:
    for system, text in failed.items():
        echo(f"mav key: vehicle {system}: {text}", error=True)
    if arguments.json:
        facts = {
            "finished": not failed,
            "key": rotation.next_name if failed else rotation.name,
            "fingerprint": rotation.new.fingerprint,
            "old_key": rotation.name if failed else rotation.old_name,
            "changed": [system for system in systems if system not in failed],
            "failed": {str(system): text for system, text in failed.items()},
        }
        echo_json(facts)
    elif failed:
        left = systems_text(failed)
        echo(f"vehicles without the new key: {left}; the same command continues", error=True)
    else:
        kept = f"the old one is kept as {rotation.old_name} for vehicles that were off"
        echo(f"{rotation.name} is the new key now; {kept}")
