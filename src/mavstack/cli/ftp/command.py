"""`mav ftp`: list, download, upload and manage the files on a vehicle."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_vehicle_action, on_vehicle, run_on_vehicle
from mavstack.cli.common.errors import CommandError, UsageError, failure_text
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.common.selection import of_vehicle
from mavstack.cli.common.text import size_text
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.ftp.download import Download, target_for
from mavstack.cli.ftp.limited import LimitedFtp, add_entries_option, add_size_option, add_timeout_option
from mavstack.cli.ftp.paths import RemotePath, find, is_pattern, join, local_name, look_up, split, walk
from mavstack.cli.ftp.upload import Upload
from mavstack.errors import FileDenied, MavstackError, RemoteTimeout

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.vehicle import Vehicle

EXAMPLES = """\
examples:
  mav ftp ls
  mav ftp ls '/APM/LOGS/*.BIN'
  mav ftp ls /fs/microsd/log --json
  mav ftp get /APM/LOGS/00000001.BIN
  mav ftp get -r /APM/scripts backup/
  mav ftp put patrol.lua /APM/scripts/
  mav ftp mkdir /APM/scripts/modules
  mav ftp rename /APM/scripts/patrol.lua /APM/scripts/old.lua
  mav ftp crc /APM/scripts/old.lua
  mav ftp rm /APM/scripts/old.lua
  mav ftp rm -r /APM/scripts/modules
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "ftp", EXAMPLES)
    action = add_vehicle_action(actions, "ls", "list a directory", list_files)
    action.add_argument(
        "path", nargs="?", default="/", metavar="PATH", help="directory, file or pattern (default: /)"
    )
    add_entries_option(action)
    add_timeout_option(action)
    _add_get(actions)
    action = add_vehicle_action(actions, "put", "upload a file, and compare checksums", put, changes=True)
    action.add_argument("local", metavar="LOCAL", help="file on this machine")
    action.add_argument("path", metavar="REMOTE", help="file or directory on the vehicle")
    add_timeout_option(action)
    action = add_vehicle_action(actions, "rm", "remove files", remove, changes=True)
    action.add_argument("paths", nargs="+", metavar="PATH", help="file or pattern; with -r also a directory")
    _add_recursive(action, "remove directories with their contents")
    action = add_vehicle_action(actions, "mkdir", "make directories", make_directories, changes=True)
    action.add_argument("paths", nargs="+", metavar="PATH", help="directory on the vehicle")
    action = add_vehicle_action(
        actions, "rename", "rename or move a file or a directory", rename, changes=True
    )
    action.add_argument("path", metavar="FROM", help="path on the vehicle")
    action.add_argument("to", metavar="TO", help="new path on the vehicle")
    action = add_vehicle_action(actions, "crc", "show checksums of files (CRC-32 of MAVLink FTP)", checksum)
    action.add_argument("paths", nargs="+", metavar="PATH", help="file on the vehicle")
    add_timeout_option(action)


def _add_get(actions: Actions) -> None:
    action = add_vehicle_action(actions, "get", "download files", get)
    action.add_argument("path", metavar="REMOTE", help="file or pattern; with -r also a directory")
    action.add_argument(
        "local", nargs="?", metavar="LOCAL", help="file or directory (default: the current directory)"
    )
    _add_recursive(action, "download directories with their contents")
    add_size_option(
        action,
        "fail if the files have more bytes together, such as 500k or 2G, whatever their listed sizes "
        "(default: about 1 GB, and for each file about twice its listed size)",
    )


def _add_recursive(parser: ArgumentParser, text: str) -> None:
    parser.add_argument("-r", "--recursive", action="store_true", help=text)
    add_entries_option(parser)
    add_timeout_option(parser)


@on_vehicle
async def list_files(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav ftp ls`."""
    path = arguments.path
    found = await (find if is_pattern(path) else _entries)(LimitedFtp(vehicle, arguments), path)
    found.sort(key=lambda each: (not each.entry.is_directory, each.path))
    if is_pattern(path) and not found:
        raise CommandError(f"no file on the vehicle matches {path}")
    _show(found, full_path=is_pattern(path), as_json=arguments.json)
    return 0


@on_vehicle
async def get(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav ftp get`; a file that fails does not stop the others."""
    ftp = LimitedFtp(vehicle, arguments)
    jobs = await _downloads(ftp, arguments)
    failed = False
    for number, (found, target) in enumerate(jobs, 1):
        name = found.path if len(jobs) == 1 else f"{found.path} ({number} of {len(jobs)})"
        try:
            size = await _download(ftp, found, target, name)
        except RemoteTimeout:
            raise
        except (MavstackError, OSError) as error:
            failed = True
            echo(f"mav ftp: {failure_text(error)}", error=True)
        else:
            text = f"{found.path} -> {target} ({size_text(size)})"
            _report(arguments, {"remote": found.path, "local": str(target), "size": size}, text)
    return 1 if failed else 0


def put(arguments: Namespace) -> int:
    """Run `mav ftp put`."""
    local = Path(arguments.local)
    data = local.read_bytes()

    async def work(vehicle: Vehicle) -> int:
        path, ftp = arguments.path, LimitedFtp(vehicle, arguments)
        if path.endswith("/") or await _is_directory(ftp, path):
            path = join(path, local.name)
        with TransferProgress(f"{local} -> {path}") as progress:
            await Upload(vehicle, ftp, path).run(data, progress)
        text = f"{local} -> {path} ({size_text(len(data))})"
        _report_change(arguments, vehicle, {"local": str(local), "remote": path, "size": len(data)}, text)
        return 0

    return run_on_vehicle(arguments, work)


def remove(arguments: Namespace) -> int:
    """Run `mav ftp rm`."""
    if any(not path.strip("/") for path in arguments.paths):
        raise UsageError("the root directory cannot be removed; name its entries")

    async def work(vehicle: Vehicle) -> int:
        ftp = LimitedFtp(vehicle, arguments)
        for pattern in arguments.paths:
            chosen = await find(ftp, pattern)
            if not chosen:
                raise CommandError(f"no file on the vehicle matches {pattern}")
            for found in chosen:
                await _remove(vehicle, ftp, found, arguments)
        return 0

    return run_on_vehicle(arguments, work)


@on_vehicle
async def make_directories(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav ftp mkdir`."""
    for path in arguments.paths:
        await vehicle.ftp.make_directory(path.rstrip("/") or "/")
        _report_change(arguments, vehicle, {"made": path}, f"{path} made")
    return 0


@on_vehicle
async def rename(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav ftp rename`."""
    await vehicle.ftp.rename(arguments.path, arguments.to)
    facts = {"from": arguments.path, "to": arguments.to}
    _report_change(arguments, vehicle, facts, f"{arguments.path} -> {arguments.to}")
    return 0


@on_vehicle
async def checksum(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav ftp crc`."""
    ftp = LimitedFtp(vehicle, arguments)
    for path in arguments.paths:
        crc = await ftp.checksum(path)
        _report(arguments, {"path": path, "crc": crc}, f"{crc:08x}  {path}")
    return 0


async def _entries(ftp: LimitedFtp, path: str) -> list[RemotePath]:
    """List the entries of a directory, or a file itself."""
    try:
        return [RemotePath(join(path, each.name), each) for each in await ftp.list(path)]
    except FileDenied:
        return [RemotePath(path, await look_up(ftp, path))]


async def _is_directory(ftp: LimitedFtp, path: str) -> bool:
    try:
        return (await look_up(ftp, path)).is_directory
    except FileDenied:
        return False


async def _downloads(ftp: LimitedFtp, arguments: Namespace) -> list[tuple[RemotePath, Path]]:
    """Return the files to download with their local paths; local directories are made."""
    chosen = await find(ftp, arguments.path)
    if not chosen:
        raise CommandError(f"no file on the vehicle matches {arguments.path}")
    into_directory = target_for(arguments.local, "").is_dir() or arguments.local is None
    jobs = []
    for found in chosen:
        if not found.entry.is_directory:
            several = len(chosen) > 1
            target = Path(arguments.local or ".") / local_name(found.entry.name)
            jobs.append(
                (found, target if several else target_for(arguments.local, local_name(found.entry.name)))
            )
        elif not arguments.recursive:
            raise UsageError(f"{found.path} is a directory; add -r to download its contents")
        else:
            top = Path(arguments.local or ".")
            jobs += await _tree(
                ftp, found, top / local_name(split(found.path)[1] or "root") if into_directory else top
            )
    ftp.check_sizes((found.entry for found, _ in jobs), arguments.path)
    return jobs


async def _tree(ftp: LimitedFtp, top: RemotePath, target: Path) -> list[tuple[RemotePath, Path]]:
    """Return the files below a directory with their local paths; local directories are made."""
    jobs, directories = [], []
    async for found in walk(ftp, top):
        below = found.path[len(top.path.rstrip("/")) :].strip("/")
        place = target.joinpath(*map(local_name, below.split("/"))) if below else target
        if found.entry.is_directory:
            directories.append(place)
        else:
            jobs.append((found, place))
    ftp.check_sizes((found.entry for found, _ in jobs), top.path)
    for place in directories:  # directories are created once the whole tree is known and not too large
        place.mkdir(parents=True, exist_ok=True)
    return jobs


async def _download(ftp: LimitedFtp, found: RemotePath, target: Path, name: str) -> int:
    target.parent.mkdir(parents=True, exist_ok=True)
    with TransferProgress(name) as progress:
        return await Download(ftp, found.path, target, found.entry.size, progress).run()


async def _remove(vehicle: Vehicle, ftp: LimitedFtp, found: RemotePath, arguments: Namespace) -> None:
    """Remove a file, or a directory with its contents."""
    if found.entry.is_directory and not arguments.recursive:
        raise UsageError(f"{found.path} is a directory; add -r to remove it with its contents")
    everything = [each async for each in walk(ftp, found)]
    for each in reversed(everything):
        if each.entry.is_directory:
            await vehicle.ftp.remove_directory(each.path)
        else:
            await vehicle.ftp.remove(each.path)
        _report_change(arguments, vehicle, {"removed": each.path}, f"{each.path} removed")


def _show(found: list[RemotePath], *, full_path: bool, as_json: bool) -> None:
    if as_json:
        echo_json([_json(each) for each in found])
        return
    rows = [
        (
            "" if each.entry.is_directory else size_text(each.entry.size),
            (each.path if full_path else each.entry.name) + ("/" if each.entry.is_directory else ""),
        )
        for each in found
    ]
    if rows:
        echo(*align_columns(rows, right=frozenset({0})))


def _json(found: RemotePath) -> dict[str, object]:
    kind = "directory" if found.entry.is_directory else "file"
    size = None if found.entry.is_directory else found.entry.size
    return {"path": found.path, "name": found.entry.name, "type": kind, "size": size}


def _report(arguments: Namespace, for_programs: dict[str, object], text: str) -> None:
    if arguments.json:
        echo_json(for_programs)
    elif text:
        echo(text)


def _report_change(
    arguments: Namespace, vehicle: Vehicle, for_programs: dict[str, object], text: str
) -> None:
    """Print what was changed on which vehicle."""
    _report(arguments, {"system": vehicle.system, **for_programs}, of_vehicle(vehicle, text))
