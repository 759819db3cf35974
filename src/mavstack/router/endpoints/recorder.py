"""The recorder as an endpoint: a monitor that writes every accepted packet to a file."""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError, LinkError, LogError
from mavstack.logs.recorder import Recorder
from mavstack.router.endpoints.base import ENDED, Endpoint
from mavstack.wire import Parser

if TYPE_CHECKING:
    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig, Recording

_log = logging.getLogger("mavstack.router")
#: Seconds between two writes to the disk itself: a loss of power costs at most the packets in between.
SYNC_INTERVAL = 1.0
CAPACITY = 20_000


class RecorderEndpoint(Endpoint):
    """A recorder: a queue of the engine that hears everything and sends nothing.

    Attributes:
        files: Paths of the files of this run.
    """

    def __init__(self, config: EndpointConfig, attachments: Attachments, recording: Recording) -> None:
        super().__init__(config, attachments)
        self._recording = recording
        self._recorder: Recorder | None = None
        self._parser = Parser(attachments.dialect)

    @property
    def files(self) -> list[Path]:
        """Paths of the files that were begun."""
        return [] if self._recorder is None else self._recorder.files

    async def open(self) -> None:
        """Create the file."""
        recording = self._recording
        try:
            Path(recording.path).parent.mkdir(parents=True, exist_ok=True)
            self._recorder = Recorder(
                recording.path,
                max_size=recording.max_size,
                max_duration=recording.max_time,
                keep=recording.keep,
            )
        except (LogError, InvalidArgumentError) as error:
            raise LinkError(f"cannot record to {recording.path}: {error}") from None
        except OSError as error:
            raise LinkError(f"cannot record to {recording.path}: {error.strerror or error}") from None
        number = self._attachments.engine.add_queue(
            name=self.config.name, capacity=CAPACITY, monitor=True, start=False
        )
        self._attach(number, self.config.name)
        self._spawn(self._sync(self._recorder))

    async def close(self) -> None:
        """Write what waits, and close the file."""
        for number in self._numbers:
            self.readable(number)
        await super().close()
        self._finish()

    def readable(self, number: int) -> None:
        """Write the packets that wait."""
        packets = self._parser.feed(b"".join(self._attachments.engine.pull(number)))
        if self._recorder is None:
            return
        try:
            self._recorder.write(packets, time())
        except LogError as error:
            self._fail(number, error)

    async def _sync(self, recorder: Recorder) -> None:
        while True:
            await asyncio.sleep(SYNC_INTERVAL)
            try:
                await asyncio.to_thread(recorder.sync)
            except LogError as error:
                for number in list(self._numbers):
                    self._fail(number, error)
                return

    def _fail(self, number: int, error: LogError) -> None:
        """End the recording: the disk is full, perhaps. The links go on."""
        _log.error("endpoint %s ended: %s", self.config.name, error)
        self._detach(number)
        self.state, self.reason = ENDED, str(error)

    def _finish(self) -> None:
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            try:
                recorder.close()
            except LogError as error:
                _log.error("endpoint %s: %s", self.config.name, error)
