"""The download of all parameters of a vehicle, with progress on a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.transfer_progress import TransferProgress

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.services.parameters import Parameter
    from mavstack.vehicle import Vehicle


async def download_parameters(vehicle: Vehicle, arguments: Namespace | None = None) -> dict[str, Parameter]:
    """Download all parameters of a vehicle within `--action-timeout`."""
    timeout = getattr(arguments, "action_timeout", None)
    with TransferProgress("downloading parameters", in_bytes=False) as progress:
        return dict(await vehicle.params.download(timeout=timeout, progress=progress))
