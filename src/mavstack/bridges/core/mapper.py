"""The mapper of one vehicle: messages in, samples of the active topics out. It has no clock and no transport.

It serves live vehicles and logs alike: `VehicleView.latest` is the only other source of messages.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.bridges.core.topic import Topic
    from mavstack.bridges.core.view import VehicleView
    from mavstack.dialects import Message

logger = logging.getLogger("mavstack.bridges")


class Mapper:
    """The topics of one vehicle, by the messages that make them."""

    def __init__(self, view: VehicleView, topics: Iterable[Topic]) -> None:
        self.view = view
        #: The topics by row name.
        self.topics = {topic.row.name: topic for topic in topics}
        self._reported: set[str] = set()

    def topics_of(self, source: type[Message]) -> tuple[Topic, ...]:
        """Return the active topics that a message class makes."""
        return tuple(
            topic
            for topic in self.topics.values()
            if topic.active and topic.row.convert is not None and source in topic.row.sources
        )

    def sources(self) -> set[type[Message]]:
        """Return the message classes that active topics are made of."""
        return {source for topic in self.topics.values() if topic.active for source in topic.row.sources}

    def receive(self, message: Any, arrival: int, topics: Iterable[Topic]) -> None:
        """Publish the samples of a message.

        Args:
            message: The message.
            arrival: The Unix time of its arrival in nanoseconds.
            topics: The topics that it makes, by `topics_of`.
        """
        view = self.view
        view.arrival = arrival
        for topic in topics:
            try:
                values = topic.row.convert(message, view)  # type: ignore[misc]
                if values is not None:
                    topic.publish(values, view.stamp(message))
            except Exception as error:  # noqa: BLE001 (one row must not end the others)
                self._report(topic, error)

    def tick(self, arrival: int) -> None:
        """Publish the samples of the periodic topics that are active."""
        self.view.arrival = arrival
        for topic in self.topics.values():
            if topic.row.period and topic.active:
                self.receive(None, arrival, (topic,))

    def publish(self, name: str, values: Any, stamp: int) -> None:
        """Publish a sample of a row that other parts make, by the name of the row, if it is wanted."""
        topic = self.topics.get(name)
        if topic is None or not topic.active:
            return
        try:
            topic.publish(values, stamp)
        except Exception as error:  # noqa: BLE001
            self._report(topic, error)

    def _report(self, topic: Topic, error: Exception) -> None:
        if topic.name not in self._reported:
            self._reported.add(topic.name)
            logger.warning("converting a sample of %s failed: %s", topic.name, error)
