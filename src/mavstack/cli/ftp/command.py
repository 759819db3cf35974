"""`mav ftp`: the files on a vehicle."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.field_values import clean
from mavstack.cli.common.transfer_progress import TransferProgress, size_text
from mavstack.cli.common.usage_error import UsageError
from mavstack.cli.ftp.download import Download, target_for
from mavstack.cli.ftp.paths import Found, find, is_pattern, join, local_name, look_up, split, walk
from mavstack.cli.param.text import columns, print_json
from mavstack.errors import FileDenied, MavstackError, RemoteTimeout

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

    from mavstack.node.ftp import Ftp
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
    listing = _action(actions, "ls", "list a directory", list_files)
    listing.add_argument("path", nargs="?", default="/", metavar="PATH", help="or a pattern (default: /)")
    getting = _action(actions, "get", "fetch files", get)
    getting.add_argument("path", metavar="REMOTE", help="a file, a pattern, or with -r a directory")
    getting.add_argument("local", nargs="?", metavar="LOCAL", help="a file or a directory (default: here)")
    getting.add_argument("-r", "--recursive", action="store_true", help="a directory with all that is in it")
    putting = _action(actions, "put", "store a file on the vehicle, and compare checksums", put)
    putting.add_argument("local", metavar="LOCAL")
    putting.add_argument("path", metavar="REMOTE", help="a file or a directory")
    removing = _action(actions, "rm", "remove files", remove)
    removing.add_argument("paths", nargs="+", metavar="PATH")
    removing.add_argument(
        "-r", "--recursive", action="store_true", help="directories with all that is in them"
    )
    making = _action(actions, "mkdir", "make directories", make)
    making.add_argument("paths", nargs="+", metavar="PATH")
    renaming = _action(actions, "rename", "rename or move a file or a directory", rename)
    renaming.add_argument("path", metavar="FROM")
    renaming.add_argument("to", metavar="TO")
    checking = _action(actions, "crc", "show the checksums of files (CRC-32 of MAVLink FTP)", checksum)
    checking.add_argument("paths", nargs="+", metavar="PATH")


def run(arguments: Namespace) -> int:
    """Carry out the action that was chosen."""
    code: int = arguments.run_action(arguments)
    return code


def list_files(arguments: Namespace) -> int:
    """`mav ftp ls`."""

    async def work(vehicle: Vehicle) -> int:
        path = arguments.path
        found = await (find if is_pattern(path) else _entries)(vehicle.ftp, path)
        found.sort(key=lambda each: (not each.entry.is_directory, each.path))
        if is_pattern(path) and not found:
            raise MavstackError(f"nothing on the vehicle fits {path}")
        _show(found, full_path=is_pattern(path), as_json=arguments.json)
        return 0

    return run_on_vehicle(arguments, work)


def get(arguments: Namespace) -> int:
    """`mav ftp get`; what one file comes to does not keep the others from coming."""

    async def work(vehicle: Vehicle) -> int:
        jobs = await _downloads(vehicle.ftp, arguments)
        failed = False
        for number, (found, target) in enumerate(jobs, 1):
            name = found.path if len(jobs) == 1 else f"{found.path} ({number} of {len(jobs)})"
            try:
                size = await _download(vehicle.ftp, found, target, name)
            except RemoteTimeout:
                raise
            except (MavstackError, OSError) as error:
                failed = True
                print(f"mav ftp: {clean(str(error))}", file=sys.stderr)
            else:
                text = f"{found.path} -> {target} ({size_text(size)})"
                _tell(arguments, {"remote": found.path, "local": str(target), "size": size}, text)
        return 1 if failed else 0

    return run_on_vehicle(arguments, work)


def put(arguments: Namespace) -> int:
    """`mav ftp put`."""
    local = Path(arguments.local)
    data = local.read_bytes()

    async def work(vehicle: Vehicle) -> int:
        path = arguments.path
        if path.endswith("/") or await _is_directory(vehicle.ftp, path):
            path = join(path, local.name)
        with TransferProgress(f"{local} -> {path}") as progress:
            await vehicle.ftp.upload(path, data, progress=progress)
        text = f"{local} -> {path} ({size_text(len(data))})"
        _tell(arguments, {"local": str(local), "remote": path, "size": len(data)}, text)
        return 0

    return run_on_vehicle(arguments, work)


def remove(arguments: Namespace) -> int:
    """`mav ftp rm`."""
    if any(not path.strip("/") for path in arguments.paths):
        raise UsageError("the root of a vehicle is not removed; name what is in it")

    async def work(vehicle: Vehicle) -> int:
        for pattern in arguments.paths:
            chosen = await find(vehicle.ftp, pattern)
            if not chosen:
                raise MavstackError(f"nothing on the vehicle fits {pattern}")
            for found in chosen:
                await _remove(vehicle.ftp, found, arguments)
        return 0

    return run_on_vehicle(arguments, work)


def make(arguments: Namespace) -> int:
    """`mav ftp mkdir`."""

    async def work(vehicle: Vehicle) -> int:
        for path in arguments.paths:
            await vehicle.ftp.make_directory(path.rstrip("/") or "/")
            _tell(arguments, {"made": path}, "")
        return 0

    return run_on_vehicle(arguments, work)


def rename(arguments: Namespace) -> int:
    """`mav ftp rename`."""

    async def work(vehicle: Vehicle) -> int:
        await vehicle.ftp.rename(arguments.path, arguments.to)
        _tell(arguments, {"from": arguments.path, "to": arguments.to}, "")
        return 0

    return run_on_vehicle(arguments, work)


def checksum(arguments: Namespace) -> int:
    """`mav ftp crc`."""

    async def work(vehicle: Vehicle) -> int:
        for path in arguments.paths:
            crc = await vehicle.ftp.checksum(path)
            _tell(arguments, {"path": path, "crc": crc}, f"{crc:08x}  {path}")
        return 0

    return run_on_vehicle(arguments, work)


async def _entries(files: Ftp, path: str) -> list[Found]:
    """What is in a directory, or the file itself."""
    try:
        return [Found(join(path, each.name), each) for each in await files.list(path)]
    except FileDenied:
        return [Found(path, await look_up(files, path))]


async def _is_directory(files: Ftp, path: str) -> bool:
    try:
        return (await look_up(files, path)).is_directory
    except FileDenied:
        return False


async def _downloads(files: Ftp, arguments: Namespace) -> list[tuple[Found, Path]]:
    """Which files are fetched, and where each goes."""
    chosen = await find(files, arguments.path)
    if not chosen:
        raise MavstackError(f"nothing on the vehicle fits {arguments.path}")
    into = target_for(arguments.local, "").is_dir() or arguments.local is None
    jobs = []
    for found in chosen:
        if not found.entry.is_directory:
            several = len(chosen) > 1
            target = Path(arguments.local or ".") / local_name(found.entry.name)
            jobs.append(
                (found, target if several else target_for(arguments.local, local_name(found.entry.name)))
            )
        elif not arguments.recursive:
            raise UsageError(f"{found.path} is a directory; add -r to fetch what is in it")
        else:
            top = Path(arguments.local or ".")
            jobs += await _tree(
                files, found, top / local_name(split(found.path)[1] or "root") if into else top
            )
    return jobs


async def _tree(files: Ftp, top: Found, target: Path) -> list[tuple[Found, Path]]:
    """The files below a directory; its directories are made here."""
    jobs = []
    async for found in walk(files, top):
        below = found.path[len(top.path.rstrip("/")) :].strip("/")
        place = target.joinpath(*map(local_name, below.split("/"))) if below else target
        if found.entry.is_directory:
            place.mkdir(parents=True, exist_ok=True)
        else:
            jobs.append((found, place))
    return jobs


async def _download(files: Ftp, found: Found, target: Path, name: str) -> int:
    target.parent.mkdir(parents=True, exist_ok=True)
    with TransferProgress(name) as progress:
        return await Download(files, found.path, target, found.entry.size, progress).run()


async def _remove(files: Ftp, found: Found, arguments: Namespace) -> None:
    """Remove a file, or a directory from its leaves up."""
    if found.entry.is_directory and not arguments.recursive:
        raise UsageError(f"{found.path} is a directory; add -r to remove it with all that is in it")
    everything = [each async for each in walk(files, found)]
    for each in reversed(everything):
        if each.entry.is_directory:
            await files.remove_directory(each.path)
        else:
            await files.remove(each.path)
        _tell(arguments, {"removed": each.path}, "")


def _show(found: list[Found], *, full_path: bool, as_json: bool) -> None:
    if as_json:
        print_json([_json(each) for each in found])
        return
    rows = [
        (
            "" if each.entry.is_directory else size_text(each.entry.size),
            (each.path if full_path else each.entry.name) + ("/" if each.entry.is_directory else ""),
        )
        for each in found
    ]
    if rows:
        print(*columns(rows, right=frozenset({0})), sep="\n")


def _json(found: Found) -> dict[str, object]:
    kind = "directory" if found.entry.is_directory else "file"
    size = None if found.entry.is_directory else found.entry.size
    return {"path": found.path, "name": found.entry.name, "type": kind, "size": size}


def _tell(arguments: Namespace, for_programs: dict[str, object], text: str) -> None:
    if arguments.json:
        print_json(for_programs)
    elif text:
        print(clean(text), flush=True)


def _action(actions: Actions, name: str, summary: str, run_it: Callable[[Namespace], int]) -> ArgumentParser:
    """An action with what all have in common."""
    parser = actions.add(name, summary, run_it)
    parser.add_argument("--json", action="store_true", help="for programs")
    add_connection_options(parser)
    return parser
