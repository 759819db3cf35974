"""`mav sim --firmware betaflight`: vehicles whose flight controllers speak MSP, one link for each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.sim.vehicle_types import ControllerFirmware, Firmware, VehicleType

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

#: The address at which clients of Betaflight's own simulator (SITL) connect.
DEFAULT_OUT: Final = "msp+tcpin://127.0.0.1:5761"
PREFIX: Final = "msp+"
#: Options that apply only to vehicles that speak MAVLink.
_ONLY_MAVLINK: Final = ("camera", "gimbal", "rangefinder", "obstacle", "radio", "signing_key", "mavlink")


def controller_firmwares(arguments: Namespace) -> list[ControllerFirmware]:
    """Return the firmwares that speak MSP; empty for vehicles that speak MAVLink.

    Raises:
        UsageError: The firmwares are of both kinds, or an option does not fit them.
    """
    words = [word.strip().lower() for word in arguments.firmware.split(",")]
    found = [ControllerFirmware(word) for word in words if word in tuple(ControllerFirmware)]
    if not found:
        return []
    if len(found) < len(words):
        raise UsageError(
            f"--firmware {arguments.firmware}: {', '.join(ControllerFirmware)} speak MSP, "
            f"{', '.join(Firmware)} MAVLink; simulate them by two commands"
        )
    if arguments.type.strip().lower() != VehicleType.COPTER:
        raise UsageError(f"--type {arguments.type}: {', '.join(ControllerFirmware)} fly copters only")
    for option in _ONLY_MAVLINK:
        if getattr(arguments, option, None):
            raise UsageError(
                f"--{option.replace('_', '-')} cannot be used with --firmware {arguments.firmware}"
            )
    return found


def transports(urls: Sequence[str], count: int) -> list[str]:
    """Return the URLs of the transports for a number of vehicles, one after the other for each.

    Raises:
        UsageError: A URL does not begin with `msp+`.
        LinkURLError: There are several vehicles, and a URL has no port to count from.
    """
    from mavstack.sim.fleet import link_per_vehicle

    for url in urls:
        if not url.startswith(PREFIX):
            raise UsageError(f"--out {url}: a flight controller speaks MSP; write {PREFIX}{url}")
    bare = [url.removeprefix(PREFIX) for url in urls]
    if count == 1:
        return bare
    return [each for url in bare for each in link_per_vehicle(url, count)]
