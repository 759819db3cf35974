"""Recorded video in the folder of the station: files named by vehicle, camera and time."""

from __future__ import annotations

import re
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import LogError
from mavstack.http.bodies import RefusedError
from mavstack.server.video.addresses import redacted

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    from mavstack.server.video.addresses import CameraAddress
    from mavstack.server.video.gateway import VideoGateway
    from mavstack.server.video.recorder import Recorder

SUFFIX: Final = ".mp4"
#: Maximum number of recordings at the same time.
MAX_RUNNING: Final = 8
MAX_LISTED: Final = 10_000
_NAME: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9 _.+-]{0,126}\.mp4")
_MAX_LABEL: Final = 40


class VideoRecordings:
    """The recorded video of a station.

    Args:
        gateway: Returns the cameras; raises `MissingExtraError` without the extra `video`.
        folder: The folder, made when it is needed; None: nothing is recorded.
    """

    def __init__(self, gateway: Callable[[], VideoGateway], folder: str | PathLike[str] | None) -> None:
        self._gateway = gateway
        self._folder = None if folder is None else Path(folder)
        self._recorders: dict[Recorder, str] = {}

    def list(self) -> list[dict[str, Any]]:
        """Return the files as JSON, by name."""
        if self._folder is None or not self._folder.is_dir():
            return []
        found = (each for each in self._folder.glob(f"*{SUFFIX}") if each.is_file() and not each.is_symlink())
        return [self._values(path) for path in sorted(found)[:MAX_LISTED]]

    async def start(self, address: CameraAddress, uri: str, label: str) -> dict[str, Any]:
        """Begin a recording.

        Args:
            address: The camera.
            uri: Its address as clients know it.
            label: The beginning of the names of the files, such as `copter-1-front`.

        Returns:
            The recording as JSON.

        Raises:
            RefusedError: There is no folder, or too many recordings run.
            LinkError: The camera does not answer.
            LogError: The disk is full, or the folder cannot be made.
            MissingExtraError: The extra `video` is not installed.
        """
        folder, gateway = self._require_folder(), self._gateway()
        from mavstack.server.video.recorder import Recorder, require_space

        self._recorders = {each: shown for each, shown in self._recorders.items() if each.running}
        if len(self._recorders) >= MAX_RUNNING:
            raise RefusedError(409, f"{MAX_RUNNING} cameras are recorded already: end one of the recordings")
        _make(folder)
        require_space(folder)
        recorder = Recorder(gateway, address, lambda: _new_path(folder, label))
        self._recorders[recorder] = redacted(uri)
        try:
            await recorder.start()
        except BaseException:
            self._recorders.pop(recorder, None)
            raise
        return self._values_of(recorder)

    async def stop(self, name: str) -> dict[str, Any]:
        """End a recording; raises `RefusedError` if none of this name runs."""
        recorder = self._recorder_of(name)
        if recorder is None:
            raise RefusedError(404, f"no recording {name[:60]!r} is running")
        await recorder.stop()
        return self._values_of(recorder)

    def path(self, name: str) -> Path:
        """Return the path of a file; raises `RefusedError` if there is none of that name."""
        path = self._require_folder() / name
        if not _NAME.fullmatch(name) or not path.is_file() or path.is_symlink():
            raise RefusedError(404, f"there is no video {name[:60]!r}")
        return path

    def is_growing(self, name: str) -> bool:
        """Return whether a file is being recorded."""
        recorder = self._recorder_of(name)
        return recorder is not None and recorder.paths[-1].name == name

    async def close(self) -> None:
        """End all recordings, also those that begin."""
        for recorder in tuple(self._recorders):
            await recorder.stop()

    def _recorder_of(self, name: str) -> Recorder | None:
        found = (each for each in self._recorders if name in {path.name for path in each.paths})
        return next((each for each in found if each.running), None)

    def _values_of(self, recorder: Recorder) -> dict[str, Any]:
        return self._values(recorder.paths[-1], recorder)

    def _values(self, path: Path, recorder: Recorder | None = None) -> dict[str, Any]:
        recorder = recorder or next((each for each in tuple(self._recorders) if path in each.paths), None)
        try:
            status = path.stat()
            size, modified = status.st_size, status.st_mtime
        except OSError:
            size, modified = 0, 0.0
        running = recorder is not None and recorder.running and recorder.paths[-1] == path
        return {
            "name": path.name,
            "size": size,
            "modified": modified,
            "running": running,
            "seconds": None if recorder is None else round(recorder.seconds, 1),
            "lost": 0 if recorder is None else recorder.lost,
            "problem": "" if recorder is None else recorder.problem,
            "uri": "" if recorder is None else self._recorders.get(recorder, ""),
        }

    def _require_folder(self) -> Path:
        if self._folder is None:
            raise RefusedError(409, "the station was started without a folder for recordings")
        return self._folder


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LogError(f"cannot open {folder}: {error.strerror or error}") from None


def label_of(*parts: str) -> str:
    """Return the beginning of a file name from words that others chose, such as `copter-1-front`."""
    words = (re.sub(r"[^a-z0-9]+", "-", part.lower()).strip("-") for part in parts)
    return "-".join(word for word in words if word)[:_MAX_LABEL].strip("-") or "video"


def _new_path(folder: Path, label: str) -> Path:
    stem = f"{label}-{datetime.now(UTC):%Y-%m-%d-%H%M%S}"
    number = 1
    try:
        while True:
            path = folder / f"{stem}{f'-{number}' if number > 1 else ''}{SUFFIX}"
            with suppress(FileExistsError):
                path.touch(exist_ok=False)
                return path
            number += 1
    except OSError as error:
        raise LogError(f"cannot create {path}: {error.strerror or error}") from None
