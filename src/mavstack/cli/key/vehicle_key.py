"""The state in which a vehicle takes a key."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.selection import of_vehicle

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.vehicle import Vehicle

#: Seconds to wait for a packet of the vehicle: the time of three heartbeats.
_PACKET_TIMEOUT: Final = 3.0


async def require_ready(vehicle: Vehicle, arguments: Namespace) -> None:
    """Refuse at once what the vehicle would ignore: any request while armed, unsigned ones if it signs."""
    require_disarmed(vehicle)
    if arguments.signing_key is None and await _signs(vehicle):
        raise CommandError(of_vehicle(vehicle, "it has a key already; name its present key with --key"))


def require_disarmed(vehicle: Vehicle) -> None:
    """Refuse to change the key of an armed vehicle, which would ignore it."""
    if vehicle.armed:
        raise CommandError(of_vehicle(vehicle, "it is armed; autopilots take no key then: disarm it first"))


async def _signs(vehicle: Vehicle) -> bool:
    """Return whether the next packet of the vehicle is signed."""
    async with vehicle.connection.packets(system=vehicle.system) as packets:
        with suppress(TimeoutError):
            async with asyncio.timeout(_PACKET_TIMEOUT):
                return (await anext(packets)).signed
    return False
