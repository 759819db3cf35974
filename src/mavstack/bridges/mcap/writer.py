"""An MCAP file with the profile `ros2`: schemas as `ros2msg`, messages as CDR, quality as metadata.

ROS 2 plays it (`ros2 bag play`), and Foxglove shows it. A channel begins with its first sample.
"""

from __future__ import annotations

from importlib import import_module
from typing import IO, TYPE_CHECKING, Any, Final

from mavstack.bridges.core.types import message_text, type_hash
from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from mavstack.bridges.core.qos import Qos
    from mavstack.bridges.core.topic import Topic

#: The ROS 2 numbers for the history, the reliability and the durability of a QoS profile.
_KEEP_LAST: Final = 1
_RELIABLE, _BEST_EFFORT = 1, 2
_TRANSIENT_LOCAL, _VOLATILE = 1, 2
#: Readers refuse a profile that lacks any of these keys.
_PROFILE: Final = """\
- history: {history}
  depth: {depth}
  reliability: {reliability}
  durability: {durability}
  deadline:
    sec: 2147483647
    nsec: 4294967295
  lifespan:
    sec: 2147483647
    nsec: 4294967295
  liveliness: 1
  liveliness_lease_duration:
    sec: 2147483647
    nsec: 4294967295
  avoid_ros_namespace_conventions: false
"""


class Ros2Mcap:
    """The open file.

    Args:
        stream: A file, open for writing at its beginning.

    Raises:
        MissingExtraError: The library `mcap` is not installed.
    """

    def __init__(self, stream: IO[bytes]) -> None:
        try:
            module: Any = import_module("mcap.writer")
        except ImportError:
            raise MissingExtraError("MCAP of ROS 2", "data") from None
        self._writer = module.Writer(stream)
        self._writer.start(profile="ros2", library="mavstack")
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._sequences: dict[int, int] = {}

    def add(self, topic: Topic, payload: bytes, log_time: int, publish_time: int) -> None:
        """Add a sample.

        Args:
            topic: Its topic.
            payload: Its CDR.
            log_time: When it arrived, as Unix nanoseconds.
            publish_time: Its own time, as Unix nanoseconds.
        """
        channel = self._channels.get(topic.name)
        if channel is None:
            channel = self._channels[topic.name] = self._add_channel(topic)
        sequence = self._sequences[channel] = (self._sequences.get(channel, 0) + 1) & 0xFFFFFFFF
        self._writer.add_message(channel, max(log_time, 0), payload, max(publish_time, 0), sequence)

    def finish(self) -> None:
        """Write the index behind the messages; the stream stays open."""
        self._writer.finish()

    def _add_channel(self, topic: Topic) -> int:
        schema = self._schemas.get(topic.type)
        if schema is None:
            text = message_text(topic.type).encode()
            schema = self._schemas[topic.type] = self._writer.register_schema(topic.type, "ros2msg", text)
        metadata = {
            "offered_qos_profiles": qos_text(topic.qos),
            "topic_type_hash": type_hash(topic.type),
        }
        number: int = self._writer.register_channel(topic.name, "cdr", schema, metadata)
        return number


def qos_text(qos: Qos) -> str:
    """Return the profile of a topic as rosbag2 writes it."""
    return _PROFILE.format(
        history=_KEEP_LAST,
        depth=qos.depth,
        reliability=_RELIABLE if qos.reliable else _BEST_EFFORT,
        durability=_TRANSIENT_LOCAL if qos.latched else _VOLATILE,
    )
