"""`mav log`: list, download, erase and stream the logs on a vehicle."""

from __future__ import annotations

import sys
from argparse import ArgumentTypeError
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_vehicle_action, on_vehicle, run_on_vehicle
from mavstack.cli.common.errors import CommandError, UsageError, failure_text
from mavstack.cli.common.output import align_columns, echo, echo_json, echo_question
from mavstack.cli.common.selection import of_vehicle
from mavstack.cli.common.text import size_text
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.ftp.download import Download
from mavstack.cli.ftp.limited import LimitedFtp, add_size_option, add_timeout_option
from mavstack.cli.log.files import local_file_name, log_files, log_location, match_files, time_text
from mavstack.cli.log.stream import add_stream_action
from mavstack.errors import MavstackError, RemoteError, RemoteTimeout

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.cli.ftp.paths import RemotePath
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
  mav log stream -o flight.ulg --for 20
"""

LAST, ALL = "last", "all"
_MAX_ID = 0xFFFF


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "log", EXAMPLES)
    summary = "list the logs: number, start time (UTC), size"
    add_timeout_option(add_vehicle_action(actions, "list", summary, list_logs))
    get_parser = add_vehicle_action(actions, "get", "download logs", get)
    get_parser.add_argument(
        "which", nargs="+", type=_log_number, metavar="NUMBER", help="number of a log, last, or all"
    )
    get_parser.add_argument(
        "-o", "--output", metavar="FILE", help="file or directory (default: the current directory)"
    )
    get_parser.add_argument("--force", action="store_true", help="replace a local file of another size")
    get_parser.add_argument(
        "--via",
        choices=("auto", "ftp", "log"),
        default="auto",
        help="MAVLink FTP, which is faster, or log messages (default: FTP if the file of the log is known)",
    )
    add_size_option(
        get_parser, "fail if a log has more bytes, such as 500k or 2G (default: about twice its listed size)"
    )
    add_timeout_option(get_parser)
    erase_parser = add_vehicle_action(actions, "erase", "erase all logs", erase, changes=True)
    erase_parser.add_argument("-y", "--yes", action="store_true", help="do not ask for confirmation")
    add_stream_action(actions)


@on_vehicle
async def list_logs(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav log list`."""
    logs = await vehicle.logs.list(timeout=arguments.action_timeout)
    if arguments.json:
        echo_json([{"id": log.id, "time_utc": log.time_utc or None, "size": log.size} for log in logs])
    elif logs:
        rows = [(str(log.id), time_text(log), size_text(log.size)) for log in logs]
        echo(*align_columns(rows, right=frozenset({0, 2})))
    else:
        echo("there are no logs", error=True)
    return 0


@on_vehicle
async def get(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav log get`; a log that fails does not stop the others."""
    ftp = LimitedFtp(vehicle, arguments)
    logs = await vehicle.logs.list(timeout=ftp.remaining_time())
    chosen = _chosen(logs, arguments.which)
    several = len(chosen) > 1 or ALL in arguments.which
    files = {} if arguments.via == "log" else match_files(logs, await log_files(vehicle, ftp))
    failed = False
    for log in chosen:
        try:
            target = _target(log, log_location(vehicle).suffix, arguments.output, several=several)
            await _download(vehicle, ftp, log, files.get(log.id), target, arguments)
        except RemoteTimeout:
            raise
        except (MavstackError, OSError) as error:
            failed = True
            echo(f"mav log: {failure_text(error)}", error=True)
    return 1 if failed else 0


def erase(arguments: Namespace) -> int:
    """Run `mav log erase`."""
    if not arguments.yes and not sys.stdin.isatty():
        raise UsageError("add --yes to erase all logs without confirmation")

    async def work(vehicle: Vehicle) -> int:
        logs = await vehicle.logs.list()
        if not arguments.yes and not _confirmed(vehicle, logs):
            echo("nothing was erased", error=True)
            return 1
        await vehicle.logs.erase()
        left = await vehicle.logs.list()
        if arguments.json:
            echo_json({"system": vehicle.system, "erased": len(logs), "left": len(left)})
        else:
            text = f"{len(logs)} logs erased" + (f", {len(left)} left" if left else "")
            echo(of_vehicle(vehicle, text))
        return 0

    return run_on_vehicle(arguments, work)


def _chosen(logs: Sequence[LogEntry], which: Sequence[int | str]) -> list[LogEntry]:
    """Return the logs that were named, each once."""
    if not logs:
        raise CommandError("there are no logs on the vehicle")
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
            raise CommandError(f"there is no log {name}; there are {_ranges(sorted(by_id))}")
    return list(wanted.values())


def _target(log: LogEntry, suffix: str, output: str | None, *, several: bool) -> Path:
    """Return the local path of a log: its own name in a directory, or the file that was named."""
    path, name = Path(output or "."), local_file_name(log, suffix)
    directory = several or path.is_dir() or (output or "").endswith(("/", "\\"))
    target = path / name if directory else path
    target.parent.mkdir(parents=True, exist_ok=True)
    return target


async def _download(
    vehicle: Vehicle,
    ftp: LimitedFtp,
    log: LogEntry,
    file: RemotePath | None,
    target: Path,
    arguments: Namespace,
) -> None:
    """Download a log, by MAVLink FTP if its file is known, unless it was downloaded before."""
    if not arguments.force and _is_downloaded(target, log):
        _report(arguments, log, target, "already downloaded")
        return
    if arguments.max_size is not None and log.size > arguments.max_size:
        sizes = f"{size_text(log.size)}, more than the {size_text(arguments.max_size)} allowed"
        raise CommandError(f"log {log.id} has {sizes}; --max-size allows more")
    if arguments.via == "ftp" and file is None:
        raise CommandError(f"the file of log {log.id} is not known; download the log with --via log")
    started = vehicle.connection.now()
    size, way = 0, "ftp"
    if file is not None:
        size = await _download_file(ftp, log, file, target, required=arguments.via == "ftp")
    if not size:
        size, way = await _download_log_data(vehicle, ftp, log, target, arguments.max_size), "log"
    elapsed = max(vehicle.connection.now() - started, 1e-3)
    _report(arguments, log, target, f"{size_text(size)}, {size_text(size / elapsed)}/s", way)


def _is_downloaded(target: Path, log: LogEntry) -> bool:
    """Return whether the log was downloaded before; raise if another file has its name."""
    if not target.exists():
        return False
    if target.stat().st_size != log.size:
        raise CommandError(f"{target} exists with another size; move it away, or add --force")
    return True


async def _download_file(
    ftp: LimitedFtp, log: LogEntry, file: RemotePath, target: Path, *, required: bool
) -> int:
    """Download a log by MAVLink FTP; 0 if the vehicle refuses and FTP is not required."""
    with TransferProgress(f"log {log.id}") as progress:
        try:
            return await Download(ftp, file.path, target, file.entry.size, progress).run()
        except RemoteTimeout:
            raise
        except RemoteError:
            if required:
                raise
            return 0


async def _download_log_data(
    vehicle: Vehicle, ftp: LimitedFtp, log: LogEntry, target: Path, max_size: int | None
) -> int:
    """Download a log by LOG_REQUEST_DATA."""
    with TransferProgress(f"log {log.id}") as progress:
        data = await vehicle.logs.download(
            log, max_size=max_size, timeout=ftp.remaining_time(), progress=progress
        )
    write_file_atomically(target, data)
    return len(data)


def _confirmed(vehicle: Vehicle, logs: Sequence[LogEntry]) -> bool:
    """Ask for confirmation on the terminal."""
    size = size_text(sum(log.size for log in logs))
    echo_question(f"erase all {len(logs)} logs ({size}) of vehicle {vehicle.system}? [y/N] ")
    return sys.stdin.readline().strip().lower() in ("y", "yes")


def _report(arguments: Namespace, log: LogEntry, target: Path, note: str, way: str | None = None) -> None:
    if arguments.json:
        echo_json({"id": log.id, "file": str(target), "size": target.stat().st_size, "via": way})
    else:
        echo(f"log {log.id} -> {target} ({note})")


def _log_number(text: str) -> int | str:
    if text.lower() in (LAST, ALL):
        return text.lower()
    if text.isascii() and text.isdecimal() and int(text) <= _MAX_ID:
        return int(text)
    raise ArgumentTypeError(f"{text!r} is not the number of a log, last or all")


def _ranges(numbers: Sequence[int]) -> str:
    """Return numbers as ranges: 1-3, 7."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    return ", ".join(f"{part[0]}-{part[-1]}" if len(part) > 1 else str(part[0]) for part in parts)
