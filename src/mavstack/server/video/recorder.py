"""The recording of one camera, which viewers share; after an interruption it continues in a new file.

The pauses before a camera is opened again grow while its streams are short, so that a camera that comes and
goes does not fill the folder with files.
"""

from __future__ import annotations

import asyncio
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from aiortc.mediastreams import MediaStreamError

from mavstack.errors import LinkError, LogError, MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.server.video.late_pictures import LatePictures
from mavstack.server.video.video_file import VideoFile

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from aiortc import MediaStreamTrack

    from mavstack.server.video.addresses import CameraAddress
    from mavstack.server.video.gateway import VideoGateway
    from mavstack.server.video.sources import CameraSource

#: Seconds between two attempts to open a camera that ended its stream, at first and at most.
RETRY_INTERVAL: Final = 2.0
MAX_RETRY_INTERVAL: Final = 60.0
#: Seconds of video after which a stream is not a short one.
STABLE_TIME: Final = 30.0
#: Maximum bytes of a file; the recording continues in the next one.
MAX_FILE: Final = 4 << 30
#: Bytes that stay free on the disk: a recording ends before.
MIN_FREE: Final = 1 << 30
#: Number of pictures after which the disk is examined.
_CHECK_INTERVAL: Final = 100


class Recorder:
    """A recording that runs until it is stopped, or the disk is full.

    Args:
        gateway: Opens the camera.
        address: The camera.
        new_path: Makes the next file, which is empty, and returns its path.
    """

    def __init__(self, gateway: VideoGateway, address: CameraAddress, new_path: Callable[[], Path]) -> None:
        self._gateway, self._address, self._new_path = gateway, address, new_path
        self._task: asyncio.Task[None] | None = None
        #: The files so far; the last one grows.
        self.paths: list[Path] = []
        #: The reason why nothing is recorded at present; empty: it is.
        self.problem = ""
        self._seconds = 0.0
        self._lost = 0
        self._file: VideoFile | None = None
        self._pictures: LatePictures | None = None

    @property
    def running(self) -> bool:
        """True until the recording was stopped, or the disk is full."""
        return self._task is not None and not self._task.done()

    @property
    def seconds(self) -> float:
        """Seconds of video in all files."""
        return self._seconds + (0.0 if self._file is None else self._file.seconds)

    @property
    def lost(self) -> int:
        """The number of pictures that are in no file: the disk was too slow, or they were damaged."""
        late = 0 if self._pictures is None else self._pictures.dropped
        return self._lost + late + (0 if self._file is None else self._file.damaged)

    async def start(self) -> None:
        """Open the camera and begin.

        Raises:
            LinkError: The camera does not answer, or ends its stream at once.
            RefusedError: Too many cameras are open.
            LogError: The disk is full, the file cannot be made, or `stop` was called meanwhile.
        """
        begun: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._task = asyncio.create_task(self._run(begun))
        try:
            await asyncio.wait({begun, self._task}, return_when=asyncio.FIRST_COMPLETED)
        except asyncio.CancelledError:
            await self.stop()
            raise
        if not begun.done():
            raise LogError("recording video failed: it was stopped before the camera was open")
        await begun

    async def stop(self) -> None:
        """End the recording, and wait until its file is complete. Idempotent."""
        if self._task is not None:
            self._task.cancel()
            with suppress(asyncio.CancelledError, MavstackError):
                await self._task

    async def _run(self, begun: asyncio.Future[None]) -> None:
        pause = RETRY_INTERVAL
        while True:
            before = self.seconds
            try:
                async with self._gateway.camera(self._address) as source:
                    self.problem = ""
                    await self._record(source, begun)
                if not begun.done():
                    raise LinkError("opening the camera failed: it ended its stream")
                self.problem = "the camera ended its stream; it is opened again"
            except (MavstackError, RefusedError) as error:
                self.problem = str(error)
                if not begun.done():
                    begun.set_exception(error)
                    return
                if isinstance(error, LogError):
                    return
            if self.seconds - before >= STABLE_TIME:
                pause = RETRY_INTERVAL
            await asyncio.sleep(pause)
            pause = min(2 * pause, MAX_RETRY_INTERVAL)

    async def _record(self, source: CameraSource, begun: asyncio.Future[None]) -> None:
        """Write files until the camera ends its stream."""
        track, pictures = source.subscribe(), LatePictures()
        self._pictures = pictures
        reading = asyncio.create_task(_read(track, pictures))
        try:
            while (source.is_live or pictures) and await self._fill_file(pictures, begun):
                pass
        finally:
            track.stop()
            reading.cancel()
            self._lost, self._pictures = self._lost + pictures.dropped, None

    async def _fill_file(self, pictures: LatePictures, begun: asyncio.Future[None]) -> bool:
        """Write one file; False: the camera has ended its stream."""
        path = self._new_path()
        self._file = VideoFile(path)
        self.paths.append(path)
        if not begun.done():
            begun.set_result(None)
        loop = asyncio.get_running_loop()
        # One thread keeps the order: a file is closed after a write that was cancelled.
        with_disk = ThreadPoolExecutor(1, "video-recording")
        try:
            count = 0
            while (data := await pictures.get()) is not None:
                await loop.run_in_executor(with_disk, self._file.write, data)
                count += 1
                if count % _CHECK_INTERVAL == 0 and await loop.run_in_executor(with_disk, _is_complete, path):
                    return True
            return False
        finally:
            closing = loop.run_in_executor(with_disk, self._file.close)
            with_disk.shutdown(wait=False)
            self._seconds, self._lost = self.seconds, self._lost + self._file.damaged
            self._file = None
            await asyncio.shield(closing)


async def _read(track: MediaStreamTrack, pictures: LatePictures) -> None:
    """Take the pictures of a camera at once, so that they wait only where they are bounded."""
    try:
        while True:
            pictures.put(await track.recv())  # type: ignore[arg-type]
    except MediaStreamError:
        pass
    finally:
        pictures.end()


def _is_complete(path: Path) -> bool:
    """Return whether a file has its maximum size; raises `LogError` if the disk is nearly full."""
    require_space(path.parent)
    try:
        return path.stat().st_size >= MAX_FILE
    except OSError:
        return True  # it was removed: the bytes that follow would be lost with it


def require_space(folder: Path) -> None:
    """Raise `LogError` if the disk is nearly full, or the folder is gone."""
    try:
        free = shutil.disk_usage(folder).free
    except OSError as error:
        raise LogError(f"recording video failed: {folder}: {error.strerror or error}") from None
    if free < MIN_FREE:
        raise LogError(
            f"recording video failed: {free >> 20} MiB are free on the disk, {MIN_FREE >> 20} stay free"
        )
