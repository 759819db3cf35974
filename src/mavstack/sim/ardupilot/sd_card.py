"""The look of ArduPilot's bootloader at the SD card: a firmware there is checked, and renamed by its outcome.

Simulated boards do it as those with an H7 chip; a simulated program, without a board, has no bootloader.
"""

from __future__ import annotations

from hashlib import md5
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle

_FILE: Final = "/ardupilot.abin"
_FLASHED, _WRONG, _INVALID = (
    "/ardupilot-flashed.abin",
    "/ardupilot-verify-failed.abin",
    "/ardupilot-verify.abin",
)
_SEPARATOR: Final = b"--\n"


def flash_from_sd_card(vehicle: SimulatedVehicle) -> None:
    """Look for a firmware, as the bootloader does before the autopilot starts."""
    if vehicle.board_id is None:
        return
    store = vehicle.storage.store
    try:
        file = store.open_file(_FILE)
    except OSError:
        return
    content = file.read(0, file.size())
    file.close()
    store.rename(_FILE, _outcome(content))


def _outcome(content: bytes) -> str:
    """Return the name of a firmware that was checked."""
    head, mark, image = content.partition(_SEPARATOR)
    if not mark:
        return _INVALID
    found = f"MD5: {md5(image, usedforsecurity=False).hexdigest()}".encode()
    return _FLASHED if found in head else _WRONG
