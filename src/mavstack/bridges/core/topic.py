"""A topic: one row of the table for one vehicle, with the receivers of its samples.

A sink adds a receiver while it has subscribers. A topic without receivers is not converted, except that the
topics of states keep their last samples for those who come later.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.bridges.core.types import codec_of, definition_of
from mavstack.errors import CdrError

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.core.qos import Qos
    from mavstack.bridges.core.row import Publication, Values
    from mavstack.bridges.core.types import Definition

    #: Called with the CDR bytes of a sample and its time as Unix nanoseconds.
    Receiver = Callable[[bytes, int], object]


class Topic:
    """A publication of one vehicle.

    Args:
        row: The row.
        name: The full name.
        frame: The name of the frame in its header.
        changed: Called when the first receiver is added, and when the last one is removed.
        node: The full name of its node, such as "/mavros/mavstack".
    """

    def __init__(
        self,
        row: Publication,
        name: str,
        frame: str = "",
        changed: Callable[[Topic], None] | None = None,
        node: str = "",
    ) -> None:
        #: The table row that defines the topic.
        self.row = row
        #: The full name, such as "/mavros/imu/data".
        self.name = name
        #: The full name of its node, such as "/mavros/mavstack".
        self.node = node
        #: The last samples and their times, of a topic that keeps them.
        self.history: deque[tuple[bytes, int]] = deque(maxlen=row.qos.depth)
        #: The number of samples that were published.
        self.published = 0
        #: The number of samples that could not be converted.
        self.failed = 0
        self._encode = codec_of(row.type).stamped(frame)
        self._receivers: list[Receiver] = []
        self._changed = changed

    @property
    def type(self) -> str:
        """The full name of the type."""
        return self.row.type

    @property
    def definition(self) -> Definition:
        """The definition of the type."""
        return definition_of(self.row.type)

    @property
    def qos(self) -> Qos:
        """The profile."""
        return self.row.qos

    @property
    def active(self) -> bool:
        """True if samples are wanted: there are receivers, or late subscribers get the last ones."""
        return bool(self._receivers) or self.row.qos.latched

    def add_receiver(self, receiver: Receiver) -> None:
        """Call a function with each sample from now on. It must return at once."""
        self._receivers.append(receiver)
        if len(self._receivers) == 1 and self._changed is not None:
            self._changed(self)

    def remove_receiver(self, receiver: Receiver) -> None:
        """Call it no more. Idempotent."""
        if receiver in self._receivers:
            self._receivers.remove(receiver)
            if not self._receivers and self._changed is not None:
                self._changed(self)

    def publish(self, values: Values, stamp: int) -> None:
        """Encode a sample once and pass it to all receivers.

        Args:
            values: The flat values behind the header.
            stamp: The time as Unix nanoseconds.
        """
        try:
            payload = self._encode(stamp, values)
        except CdrError:
            self.failed += 1
            raise
        self.published += 1
        if self.row.qos.latched:
            self.history.append((payload, stamp))
        for receiver in self._receivers:
            receiver(payload, stamp)
