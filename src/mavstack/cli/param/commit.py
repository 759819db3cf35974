"""The option `--save` of `mav param`: save the parameters on the vehicle, so that they outlast a restart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.selection import of_vehicle
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from argparse import ArgumentParser

    from mavstack.vehicle import Vehicle


def add_save_option(parser: ArgumentParser) -> None:
    """Declare `--save`."""
    parser.add_argument(
        "--save",
        action="store_true",
        help="save on the vehicle, so that values outlast a restart; ArduPilot and PX4 save by themselves",
    )


async def commit(vehicle: Vehicle) -> None:
    """Save the parameters on the vehicle; raises RemoteError."""
    await with_status_texts(vehicle, vehicle.params.commit())


def unsaved_hint(vehicle: Vehicle, *, saved: bool) -> list[str]:
    """Return a line that says whether the values outlast a restart; none if the firmware saves by itself."""
    if vehicle.params.unsaved:
        hint = "a restart reverts these values" if saved else "--save keeps these values over a restart"
        return [of_vehicle(vehicle, f"not yet saved; {hint}")]
    return [of_vehicle(vehicle, "saved")] if saved else []
