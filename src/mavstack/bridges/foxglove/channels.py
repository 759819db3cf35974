"""Channels of the Foxglove server: topics of vehicles that are converted while a client has subscribed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from foxglove import Channel, Schema

from mavstack.bridges.core.types import message_text

if TYPE_CHECKING:
    from foxglove import Context

    from mavstack.bridges.core.topic import Topic
    from mavstack.bridges.foxglove.panels import Panel

ENCODING: Final = "cdr"
SCHEMA_ENCODING: Final = "ros2msg"


class TopicChannel:
    """One channel, with the number of its subscriptions.

    Args:
        topic: The topic of the vehicle.
        channel: The channel of the server.
        panel: How samples are converted; None: they are passed as they are.
    """

    def __init__(self, topic: Topic, channel: Any, panel: Panel | None = None) -> None:
        #: The number of samples that could not be converted.
        self.failed = 0
        self._topic = topic
        self._channel = channel
        self._panel = panel
        self._subscriptions = 0

    def subscribe(self) -> None:
        """Begin to convert for the first subscription, and send the states that are kept for each."""
        self._subscriptions += 1
        if self._subscriptions == 1:
            self._topic.add_receiver(self._receive)
        for payload, stamp in self._topic.history:
            self._receive(payload, stamp)

    def unsubscribe(self) -> None:
        """Convert no more after the last subscription."""
        self._subscriptions -= 1
        if self._subscriptions == 0:
            self._topic.remove_receiver(self._receive)

    def close(self) -> None:
        """Remove the channel."""
        self._topic.remove_receiver(self._receive)
        self._channel.close()

    def _receive(self, payload: bytes, stamp: int) -> None:
        """Pass a sample to the server, which has a bounded queue for each client."""
        if self._panel is None:
            self._channel.log(payload, log_time=stamp)
            return
        try:
            encoded = self._panel.encode(self._topic, payload, stamp)
        except (TypeError, ValueError, OverflowError):  # the schema of Foxglove cannot hold the value
            self.failed += 1
        else:
            self._channel.log(encoded, log_time=stamp)


def ros_channel(topic: Topic, context: Context) -> tuple[int, TopicChannel]:
    """Return the number and the channel of a topic with its schema of ROS 2."""
    made = Channel(topic.name, message_encoding=ENCODING, schema=ros_schema(topic.type), context=context)
    return made.id(), TopicChannel(topic, made)


def panel_channel(topic: Topic, panel: Panel, namespace: str, context: Context) -> tuple[int, TopicChannel]:
    """Return the number and the channel of a topic with a schema of Foxglove."""
    made = Channel(
        f"{namespace}/{panel.name}",
        message_encoding="protobuf",
        schema=panel.message.get_schema(),
        context=context,
    )
    return made.id(), TopicChannel(topic, made, panel)


def ros_schema(type_name: str) -> Schema:
    """Return the schema of a type of ROS 2."""
    return Schema(name=type_name, encoding=SCHEMA_ENCODING, data=message_text(type_name).encode())
