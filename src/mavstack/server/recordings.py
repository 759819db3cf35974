"""The recordings of a station: tlogs and logs of vehicles in one folder, read by their names.

Clients name files, never paths: a name that leads out of the folder is refused.
"""

from __future__ import annotations

import re
from contextlib import ExitStack, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import LogError
from mavstack.http.bodies import RefusedError

if TYPE_CHECKING:
    from os import PathLike

    from mavstack.node.recording import Recording
    from mavstack.vehicle import Connection

#: Pattern of allowed file names: without folders, and not hidden.
NAME_PATTERN: Final = r"[A-Za-z0-9_][A-Za-z0-9 _.+-]{0,126}"
#: The suffixes of the files that are listed and read.
SUFFIXES: Final = frozenset({".tlog", ".pcap", ".pcapng", ".bin", ".ulg", ".log", ".bbl", ".bfl"})
MAX_LISTED: Final = 10_000
#: Maximum number of simultaneous recordings: each one writes every packet to an open file.
MAX_RUNNING: Final = 16


class Recordings:
    """The folder of a station's recordings.

    Args:
        connection: The connection whose packets are recorded.
        folder: The folder, made when it is needed; None: nothing can be recorded or read.
    """

    def __init__(self, connection: Connection, folder: str | PathLike[str] | None) -> None:
        self._connection = connection
        self._folder = None if folder is None else Path(folder)
        self._running: dict[str, Recording] = {}

    def list(self) -> list[dict[str, Any]]:
        """Return the files in the folder as JSON, by name."""
        if self._folder is None or not self._folder.is_dir():
            return []
        paths = sorted(path for path in self._folder.iterdir() if _is_log(path))[:MAX_LISTED]
        return [self._values(path) for path in paths]

    def start(self, name: str | None = None) -> dict[str, Any]:
        """Begin a recording.

        Args:
            name: The name of a new tlog; None: one with the time of day.

        Returns:
            The recording as JSON.

        Raises:
            RefusedError: There is no folder, the name is not allowed, or too many recordings run.
            LogError: The file exists, or cannot be created.
        """
        folder = self._require_folder()
        if len(self._running) >= MAX_RUNNING:
            raise RefusedError(409, f"{MAX_RUNNING} recordings run already: end one of them")
        name = name or f"{datetime.now(UTC):%Y-%m-%d-%H%M%S}.tlog"
        path = self._path(name if name.lower().endswith((".tlog", ".pcap")) else f"{name}.tlog")
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise LogError(f"cannot open {folder}: {error.strerror or error}") from None
        self._running[path.name] = self._connection.record(path)
        return self._values(path)

    def stop(self, name: str) -> dict[str, Any]:
        """End a recording; raises `RefusedError` if none of that name runs, `LogError` if it was damaged."""
        recording = self._running.pop(name, None)
        if recording is None:
            raise RefusedError(404, f"no recording {name[:60]!r} is running")
        recording.close()
        return self._values(self._path(name))

    def keep(self, name: str, data: bytes) -> dict[str, Any]:
        """Write a log of a vehicle into the folder, in the place of an older copy.

        Args:
            name: The name of the file.
            data: Its bytes.

        Returns:
            The file as JSON.

        Raises:
            RefusedError: There is no folder, or the name is not allowed.
            LogError: The file cannot be written.
        """
        path = self._path(name)
        part = path.with_name(f".{path.name}.part")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            part.write_bytes(data)
            part.replace(path)
        except OSError as error:
            with suppress(OSError):
                part.unlink()
            raise LogError(f"cannot write {path}: {error.strerror or error}") from None
        return self._values(path)

    def path(self, name: str) -> Path:
        """Return the path of a recording or a log; raises `RefusedError` if there is none of that name."""
        path = self._path(name)
        if not _is_log(path):
            raise RefusedError(404, f"there is no log {name[:60]!r}")
        return path

    def is_running(self, name: str) -> bool:
        """Return whether a recording of that name runs, so that its file grows."""
        return name in self._running

    async def close(self) -> None:
        """End all recordings; an error of one does not keep the others from ending."""
        with ExitStack() as steps:
            for name in self._running:
                steps.callback(self.stop, name)

    def _values(self, path: Path) -> dict[str, Any]:
        recording = self._running.get(path.name)
        try:
            status = path.stat()
            size, modified = status.st_size, status.st_mtime
        except OSError:
            size, modified = 0, 0.0
        running = recording is not None
        packets = None if recording is None else recording.packets
        return {
            "name": path.name,
            "size": size,
            "modified": modified,
            "running": running,
            "packets": packets,
        }

    def _path(self, name: str) -> Path:
        if not re.fullmatch(NAME_PATTERN, name):
            raise RefusedError(400, f"{name[:60]!r} is not a file name: letters, digits, space and _.+- only")
        return self._require_folder() / name

    def _require_folder(self) -> Path:
        if self._folder is None:
            raise RefusedError(409, "the station was started without a folder for recordings")
        return self._folder


def _is_log(path: Path) -> bool:
    return path.suffix.lower() in SUFFIXES and path.is_file() and not path.is_symlink()
