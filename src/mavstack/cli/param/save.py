"""`mav param save`: save the parameters of a vehicle to a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.identity import entry_words
from mavstack.cli.common.output import echo, echo_json, echo_text
from mavstack.cli.common.selection import of_vehicle, selects_several
from mavstack.cli.param.download import download_parameters
from mavstack.cli.param.text import matching
from mavstack.dialects import common
from mavstack.errors import ParameterFileError, RemoteError
from mavstack.files.parameters import FORMATS, ParameterFile, format_for, write_parameters

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.vehicle import Vehicle

_STACKS = {common.MavAutopilot.ARDUPILOTMEGA: "ArduPilot", common.MavAutopilot.PX4: "PX4 Pro"}
#: The placeholder of the system id in the name of a file.
_SYSTEM = "{system}"
#: Seconds to wait for the version, which is written at the head of the file.
_VERSION_TIMEOUT = 3.0


def save(arguments: Namespace) -> int:
    """Run `mav param save`."""
    format_name = _format_name(arguments)
    if selects_several(arguments) and _SYSTEM not in arguments.file:
        raise UsageError(f"several vehicles need a file each: put {_SYSTEM} into its name")

    async def work(vehicle: Vehicle) -> int:
        known = await download_parameters(vehicle, arguments)
        found = matching(arguments.patterns, known)
        system, component = vehicle.address
        file = ParameterFile.of(
            (found[name] for name in sorted(found)),
            system=system,
            component=component,
            comments=await _comments(vehicle),
        )
        if arguments.file == "-":
            echo_text(FORMATS[format_name].write(file))
            return 0
        path = arguments.file.replace(_SYSTEM, str(system))
        write_parameters(path, file, format_name)
        if arguments.json:
            echo_json({"system": system, "file": path, "format": format_name, "parameters": len(found)})
        else:
            echo(of_vehicle(vehicle, f"{len(found)} parameters in {path}"))
        return 0

    return run_on_vehicle(arguments, work)


def _format_name(arguments: Namespace) -> str:
    """Return the format of the file; it is decided before the connection is opened."""
    if arguments.format:
        return str(arguments.format)
    if arguments.file == "-":
        raise UsageError(f"standard output has no suffix; add --format, one of {', '.join(FORMATS)}")
    try:
        return format_for(arguments.file).name
    except ParameterFileError as error:
        raise UsageError(f"{error}, or add --format") from None


async def _comments(vehicle: Vehicle) -> list[str]:
    """Return the firmware and its version as QGroundControl writes them at the head of a file."""
    info = vehicle.component.info
    lines = []
    if info is not None:
        stack = _STACKS.get(common.MavAutopilot(info.autopilot))
        lines.append(f"Stack: {stack or entry_words(common.MavAutopilot(info.autopilot).name)}")
        lines.append(f"Vehicle: {entry_words(getattr(info.type, 'name', str(int(info.type))))}")
    try:
        version = await vehicle.component.get_version(timeout=_VERSION_TIMEOUT)
    except RemoteError:
        return lines
    lines.append(f"Version: {version.flight}")
    if version.git_hash:
        lines.append(f"Git Revision: {version.git_hash}")
    return lines
