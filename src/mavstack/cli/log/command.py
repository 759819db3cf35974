"""`mav log`: the logs on a vehicle, listed, fetched, erased."""

from __future__ import annotations

import sys
from argparse import ArgumentTypeError
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.transfer_progress import TransferProgress, size_text
from mavstack.cli.common.usage_error import UsageError
from mavstack.cli.ftp.download import Download
from mavstack.cli.log.files import files_of, match, name_for, place_of, time_text
from mavstack.cli.param.text import columns, print_json
from mavstack.errors import MavstackError, RemoteError, RemoteTimeout

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Sequence

    from mavstack.cli.ftp.paths import Found
    from mavstack.services.log import LogEntry
    from mavstack.vehicle import Vehicle

EXAMPLES = """\
examples:
  mav log list
  mav log list --json
  mav log get last
  mav log get 1 -o flight.BIN
  mav log get 1 last -o logs/
  mav log get all -o logs/
  mav log erase --yes
"""

LAST, ALL = "last", "all"
_LAST_ID = 0xFFFF


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "log", EXAMPLES)
    _action(actions, "list", "list the logs: number, time (UTC), size", list_logs)
    getting = _action(actions, "get", "fetch logs", get)
    getting.add_argument("which", nargs="+", type=_which, metavar="NUMBER", help="or last, or all")
    getting.add_argument("-o", "--output", metavar="PATH", help="a file or a directory (default: here)")
    getting.add_argument("--force", action="store_true", help="replace a local file that is another")
    getting.add_argument(
        "--via",
        choices=("auto", "ftp", "log"),
        default="auto",
        help="MAVLink FTP, which is faster, or the log messages (default: FTP where the log's file is known)",
    )
    erasing = _action(actions, "erase", "erase all logs", erase)
    erasing.add_argument("-y", "--yes", action="store_true", help="do not ask")


def run(arguments: Namespace) -> int:
    """Carry out the action that was chosen."""
    code: int = arguments.run_action(arguments)
    return code


def list_logs(arguments: Namespace) -> int:
    """`mav log list`."""

    async def work(vehicle: Vehicle) -> int:
        logs = await vehicle.logs.list()
        if arguments.json:
            print_json([{"id": log.id, "time_utc": log.time_utc or None, "size": log.size} for log in logs])
        elif logs:
            rows = [(str(log.id), time_text(log), size_text(log.size)) for log in logs]
            print(*columns(rows, right=frozenset({0, 2})), sep="\n")
        else:
            print("there are no logs", file=sys.stderr)
        return 0

    return run_on_vehicle(arguments, work)


def get(arguments: Namespace) -> int:
    """`mav log get`; what one log comes to does not keep the others from coming."""

    async def work(vehicle: Vehicle) -> int:
        logs = await vehicle.logs.list()
        chosen = _chosen(logs, arguments.which)
        several = len(chosen) > 1 or ALL in arguments.which
        files = {} if arguments.via == "log" else match(logs, await files_of(vehicle))
        failed = False
        for log in chosen:
            try:
                target = _target(log, place_of(vehicle)[1], arguments.output, several=several)
                await _fetch(vehicle, log, files.get(log.id), target, arguments)
            except RemoteTimeout:
                raise
            except (MavstackError, OSError) as error:
                failed = True
                print(f"mav log: {error}", file=sys.stderr)
        return 1 if failed else 0

    return run_on_vehicle(arguments, work)


def erase(arguments: Namespace) -> int:
    """`mav log erase`."""
    if not arguments.yes and not sys.stdin.isatty():
        raise UsageError("add --yes to erase all logs without being asked")

    async def work(vehicle: Vehicle) -> int:
        logs = await vehicle.logs.list()
        if not arguments.yes and not _is_sure(vehicle, logs):
            print("nothing was erased", file=sys.stderr)
            return 1
        await vehicle.logs.erase()
        left = await vehicle.logs.list()
        if arguments.json:
            print_json({"erased": len(logs), "left": len(left)})
        else:
            print(f"{len(logs)} logs erased" + (f", {len(left)} left" if left else ""))
        return 0

    return run_on_vehicle(arguments, work)


def _chosen(logs: Sequence[LogEntry], which: Sequence[int | str]) -> list[LogEntry]:
    """The logs that were named, each once."""
    if not logs:
        raise MavstackError("there are no logs on the vehicle")
    by_id = {log.id: log for log in logs}
    wanted: dict[int, LogEntry] = {}
    for name in which:
        if name == ALL:
            wanted.update(by_id)
        elif name == LAST:
            newest = max(logs, key=lambda log: (log.time_utc, log.id))
            wanted[newest.id] = newest
        elif name in by_id:
            wanted[int(name)] = by_id[int(name)]
        else:
            raise MavstackError(f"there is no log {name}; there are {_ranges(sorted(by_id))}")
    return list(wanted.values())


def _target(log: LogEntry, suffix: str, output: str | None, *, several: bool) -> Path:
    """Where a log goes: into a directory by its own name, or to the file that was named."""
    path, name = Path(output or "."), name_for(log, suffix)
    directory = several or path.is_dir() or (output or "").endswith(("/", "\\"))
    target = path / name if directory else path
    target.parent.mkdir(parents=True, exist_ok=True)
    return target


async def _fetch(
    vehicle: Vehicle, log: LogEntry, file: Found | None, target: Path, arguments: Namespace
) -> None:
    """Fetch one log by the way that is open, unless it is here already."""
    if not arguments.force and _is_here(target, log):
        _tell(arguments, log, target, "is here already")
        return
    if arguments.via == "ftp" and file is None:
        raise MavstackError(f"which file log {log.id} is cannot be told; fetch it with --via log")
    began = vehicle.connection.now()
    size, way = 0, "ftp"
    if file is not None:
        size = await _by_file(vehicle, log, file, target, must=arguments.via == "ftp")
    if not size:
        size, way = await _by_number(vehicle, log, target), "log"
    elapsed = max(vehicle.connection.now() - began, 1e-3)
    _tell(arguments, log, target, f"{size_text(size)}, {size_text(size / elapsed)}/s", way)


def _is_here(target: Path, log: LogEntry) -> bool:
    """Whether the log was fetched before; raises if another file is in its place."""
    if not target.exists():
        return False
    if target.stat().st_size != log.size:
        raise MavstackError(f"{target} is there and another file; move it away, or add --force")
    return True


async def _by_file(vehicle: Vehicle, log: LogEntry, file: Found, target: Path, *, must: bool) -> int:
    """Fetch it by MAVLink FTP; 0 if the vehicle refuses and there is another way."""
    with TransferProgress(f"log {log.id}") as progress:
        try:
            return await Download(vehicle.ftp, file.path, target, file.entry.size, progress).run()
        except RemoteTimeout:
            raise
        except RemoteError:
            if must:
                raise
            return 0


async def _by_number(vehicle: Vehicle, log: LogEntry, target: Path) -> int:
    """Fetch it by its number."""
    with TransferProgress(f"log {log.id}") as progress:
        data = await vehicle.logs.download(log, progress=progress)
    part = target.with_name(f".{target.name}.part")
    try:
        part.write_bytes(data)
        part.replace(target)
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
    return len(data)


def _is_sure(vehicle: Vehicle, logs: Sequence[LogEntry]) -> bool:
    """Ask on the terminal."""
    size = size_text(sum(log.size for log in logs))
    print(f"erase all {len(logs)} logs ({size}) of system {vehicle.system}? [y/N] ", end="", flush=True)
    return sys.stdin.readline().strip().lower() in ("y", "yes")


def _tell(arguments: Namespace, log: LogEntry, target: Path, what: str, way: str | None = None) -> None:
    if arguments.json:
        print_json({"id": log.id, "file": str(target), "size": target.stat().st_size, "via": way})
    else:
        print(f"log {log.id} -> {target} ({what})", flush=True)


def _which(text: str) -> int | str:
    if text.lower() in (LAST, ALL):
        return text.lower()
    if text.isascii() and text.isdecimal() and int(text) <= _LAST_ID:
        return int(text)
    raise ArgumentTypeError(f"{text!r} is no number of a log, nor last, nor all")


def _ranges(numbers: Sequence[int]) -> str:
    """Numbers for people: 1-3, 7."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    return ", ".join(f"{part[0]}-{part[-1]}" if len(part) > 1 else str(part[0]) for part in parts)


def _action(actions: Actions, name: str, summary: str, run_it: Callable[[Namespace], int]) -> ArgumentParser:
    """An action with what all have in common."""
    parser = actions.add(name, summary, run_it)
    parser.add_argument("--json", action="store_true", help="for programs")
    add_connection_options(parser)
    return parser
