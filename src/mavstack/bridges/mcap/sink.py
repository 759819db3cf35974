"""A file as a sink: all topics of the vehicles, written by a thread."""

from __future__ import annotations

import logging
import time
from typing import IO, TYPE_CHECKING, Final

from mavstack.bridges.core.sink import Outbox
from mavstack.bridges.mcap.writer import Ros2Mcap
from mavstack.errors import LogError

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
    from mavstack.bridges.core.topic import Topic

logger = logging.getLogger("mavstack.bridges")
Sample = tuple["Topic", bytes, int, int]
#: Maximum number of samples in the queue to the disk: about a minute of one vehicle.
MAX_SAMPLES: Final = 20_000
#: Seconds in which the sink must write the queued samples when it closes.
_CLOSE_TIMEOUT: Final = 10.0


class McapSink:
    """A recording of topics.

    Args:
        path: The file, which must not exist.

    Raises:
        LogError: The file exists, or cannot be written.
        MissingExtraError: The library `mcap` is not installed.
    """

    def __init__(self, path: Path) -> None:
        try:
            self._stream: IO[bytes] = path.open("xb")
        except FileExistsError:
            raise LogError(f"cannot write {path}: it exists; choose another name") from None
        except OSError as error:
            raise LogError(f"cannot write {path}: {error.strerror or error}") from error
        self._file = Ros2Mcap(self._stream)
        self._outbox: Outbox[Sample] | None = None

    async def open(self) -> None:
        """Start the thread that writes."""
        self._outbox = Outbox(lambda sample: self._file.add(*sample), MAX_SAMPLES, name="mcap")

    async def close(self) -> None:
        """Write the values that wait, and complete the file. Idempotent."""
        if self._stream.closed:
            return
        if self._outbox is not None:
            self._outbox.close(_CLOSE_TIMEOUT)
        self._file.finish()
        self._stream.close()
        if self.dropped:
            logger.warning("%d samples were dropped: the disk was too slow, or failed", self.dropped)

    @property
    def dropped(self) -> int:
        """The number of samples that were dropped because the disk was too slow, or failed."""
        return 0 if self._outbox is None else self._outbox.dropped + self._outbox.failed

    def add_node(self, namespace: str, name: str) -> None:
        """Do nothing: a file has no nodes."""

    def add_topic(self, topic: Topic) -> None:
        """Write all samples of a topic from now on, and the states that it keeps."""

        def receive(payload: bytes, stamp: int) -> None:
            if self._outbox is not None:
                self._outbox.put((topic, payload, time.time_ns(), stamp))

        for payload, stamp in topic.history:
            receive(payload, stamp)
        topic.add_receiver(receive)

    def add_inlet(self, inlet: Inlet) -> None:
        """Do nothing: a file sends nothing."""

    def add_service(self, service: ServiceEndpoint) -> None:
        """Do nothing: a file calls nothing."""
