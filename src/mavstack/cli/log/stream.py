"""`mav log stream`: the log of a vehicle, written to a file while the vehicle writes it."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.cli.common.connection import add_vehicle_action, run_on_vehicle
from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import of_vehicle
from mavstack.cli.common.text import size_text

if TYPE_CHECKING:
    from argparse import Namespace
    from io import BufferedWriter

    from mavstack.cli.common.actions import Actions
    from mavstack.node.log_stream import LogStream
    from mavstack.vehicle import Vehicle


def add_stream_action(actions: Actions) -> None:
    """Declare `mav log stream`."""
    summary = "write the log of a vehicle to a file while it is recorded, until Ctrl-C (PX4)"
    parser = add_vehicle_action(actions, "stream", summary, stream)
    parser.add_argument("-o", "--output", metavar="FILE", required=True, help="the file, such as flight.ulg")
    parser.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def stream(arguments: Namespace) -> int:
    """Run `mav log stream`; the file is a valid log at any time."""
    path = Path(arguments.output)
    if path.exists() and not arguments.force:
        raise CommandError(f"{path} exists; choose another name, or add --force")

    async def work(vehicle: Vehicle) -> int:
        async with vehicle.log_stream.open() as log:
            if not arguments.json:
                echo(of_vehicle(vehicle, f"streaming its log to {path}"))
            with path.open("wb") as file:  # noqa: ASYNC230 (a local file)
                try:
                    await _write(log, file, arguments.duration)
                finally:
                    file.write(log.drain())
                    _report(arguments, vehicle, log, path)
        return 0 if log.size else 1

    return run_on_vehicle(arguments, work)


async def _write(log: LogStream, file: BufferedWriter, duration: float | None) -> None:
    with suppress(TimeoutError):
        async with asyncio.timeout(duration):
            async for data in log:
                file.write(data)
                file.flush()


def _report(arguments: Namespace, vehicle: Vehicle, log: LogStream, path: Path) -> None:
    if arguments.json:
        found = {"file": str(path), "size": log.size, "blocks": log.blocks, "lost": log.lost}
        echo_json({"system": vehicle.system} | found)
        return
    lost = f", {log.lost} of {log.blocks + log.lost} blocks lost" if log.lost else ", nothing lost"
    echo(of_vehicle(vehicle, f"{path} ({size_text(log.size)}{lost})"))
