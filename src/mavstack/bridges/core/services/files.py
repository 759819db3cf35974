"""Services of files on the vehicle: those of MAVROS, on whole files.

MAVROS reads and writes sessions of MAVLink FTP; here a file that is open for writing is kept in memory, and
closing it uploads it and checks its checksum.
"""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.row import Handler, Service
from mavstack.errors import InvalidArgumentError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.bridges.core.services.context import ServiceContext
    from mavstack.vehicle import Vehicle

Fields = dict[str, Any]
#: Maximum size in bytes of a file that is written, and of a part that is read at once.
MAX_SIZE: Final = 16 << 20
MAX_OPEN: Final = 8
_READ, _WRITE, _CREATE = 0, 1, 2
_FILE, _DIRECTORY = 0, 1


async def list_directory(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """List a directory (mavros_msgs/FileList)."""
    entries = await vehicle.ftp.list(request["dir_path"])
    found = [
        {"name": each.name, "type": _DIRECTORY if each.is_directory else _FILE, "size": each.size}
        for each in entries
    ]
    return {"list": found, "success": True}


async def open_file(vehicle: Vehicle, request: Fields, context: ServiceContext) -> Fields:
    """Open a file (mavros_msgs/FileOpen)."""
    path, mode = request["file_path"], request["mode"]
    if len(context.open_files) >= MAX_OPEN and path not in context.open_files:
        raise InvalidArgumentError(f"at most {MAX_OPEN} files can be open; close one of them")
    if mode == _CREATE:
        context.open_files[path] = bytearray()
        return {"size": 0, "success": True}
    if mode not in (_READ, _WRITE):
        raise InvalidArgumentError(f"mode must be 0, 1 or 2, got {mode}")
    size = await _size(vehicle, path)
    context.open_files[path] = None
    if mode == _WRITE:
        context.open_files[path] = bytearray(await vehicle.ftp.download(path, max_size=MAX_SIZE))
    return {"size": size, "success": True}


async def _size(vehicle: Vehicle, path: str) -> int:
    parsed = PurePosixPath(path)
    for entry in await vehicle.ftp.list(str(parsed.parent)):
        if entry.name == parsed.name and not entry.is_directory:
            return int(entry.size)
    raise InvalidArgumentError(f"there is no file {path}")


async def close_file(vehicle: Vehicle, request: Fields, context: ServiceContext) -> Fields:
    """Close a file (mavros_msgs/FileClose); one that was written is uploaded now."""
    path = request["file_path"]
    if path not in context.open_files:
        raise InvalidArgumentError(f"{path} is not open")
    written = context.open_files.pop(path)
    if written is not None:
        await vehicle.ftp.upload(path, bytes(written))
    return {"success": True}


async def read_file(vehicle: Vehicle, request: Fields, context: ServiceContext) -> Fields:
    """Read a part of a file (mavros_msgs/FileRead)."""
    path, offset, size = request["file_path"], request["offset"], request["size"]
    if size > MAX_SIZE:
        raise InvalidArgumentError(f"size must be at most {MAX_SIZE} bytes, got {size}")
    written = context.open_files.get(path)
    if written is not None:
        return {"data": bytes(written[offset : offset + size]), "success": True}
    data = await vehicle.ftp.download(path, offset=offset, size=size)
    return {"data": data, "success": True}


async def write_file(_vehicle: Vehicle, request: Fields, context: ServiceContext) -> Fields:
    """Write a part of an open file (mavros_msgs/FileWrite)."""
    path, offset, data = request["file_path"], request["offset"], request["data"]
    content = context.open_files.get(path)
    if content is None:
        raise InvalidArgumentError(f"{path} is not open for writing")
    if offset + len(data) > MAX_SIZE:
        raise InvalidArgumentError(f"a file must have at most {MAX_SIZE} bytes")
    content.extend(bytes(max(offset - len(content), 0)))
    content[offset : offset + len(data)] = data
    return {"success": True}


async def remove(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """Remove a file (mavros_msgs/FileRemove)."""
    await vehicle.ftp.remove(request["file_path"])
    return {"success": True}


async def make_directory(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """Create a directory (mavros_msgs/FileMakeDir)."""
    await vehicle.ftp.make_directory(request["dir_path"])
    return {"success": True}


async def remove_directory(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """Remove an empty directory (mavros_msgs/FileRemoveDir)."""
    await vehicle.ftp.remove_directory(request["dir_path"])
    return {"success": True}


async def rename(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """Rename a file (mavros_msgs/FileRename)."""
    await vehicle.ftp.rename(request["old_path"], request["new_path"])
    return {"success": True}


async def truncate(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """Cut a file (mavros_msgs/FileTruncate)."""
    await vehicle.ftp.truncate(request["file_path"], request["length"])
    return {"success": True}


async def checksum(vehicle: Vehicle, request: Fields, _context: ServiceContext) -> Fields:
    """Return the CRC-32 of a file (mavros_msgs/FileChecksum)."""
    return {"crc32": await vehicle.ftp.checksum(request["file_path"]), "success": True}


async def reset(_vehicle: Vehicle, _request: Fields, context: ServiceContext) -> Fields:
    """Forget all open files (std_srvs/Empty)."""
    context.open_files.clear()
    return {}


def _row(name: str, kind: str, handle: Handler, meaning: str, required: tuple[str, ...] = ()) -> Service:
    full = kind if "/" in kind else f"mavros_msgs/srv/{kind}"
    return Service(f"ftp/{name}", full, handle, Role.ADMINISTER, meaning, required=required)


ROWS: Final = (
    _row("list", "FileList", list_directory, "list a directory"),
    _row("open", "FileOpen", open_file, "open a file"),
    _row("close", "FileClose", close_file, "upload a written file"),
    _row("read", "FileRead", read_file, "read a part"),
    _row("write", "FileWrite", write_file, "write a part, in memory until closed"),
    _row("mkdir", "FileMakeDir", make_directory, "create a directory"),
    _row("rmdir", "FileRemoveDir", remove_directory, "remove a directory"),
    _row("remove", "FileRemove", remove, "remove a file"),
    _row("truncate", "FileTruncate", truncate, "cut a file", required=("length",)),
    _row("reset", "std_srvs/srv/Empty", reset, "forget open files"),
    _row("rename", "FileRename", rename, "rename"),
    _row("checksum", "FileChecksum", checksum, "CRC-32"),
)
