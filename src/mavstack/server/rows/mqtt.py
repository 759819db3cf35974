"""Messages of an MQTT broker as a link: each message of a topic is one chunk. It only receives."""

from __future__ import annotations

import logging
from time import time
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.bridges.mqtt.broker import Arrived, Broker, Session
from mavstack.errors import LinkURLError
from mavstack.links.base import Link
from mavstack.links.channel import Channel, Data
from mavstack.links.scheme import AddressKind, LinkScheme

if TYPE_CHECKING:
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

logger = logging.getLogger("mavstack.links")
MAX_TOPICS: Final = 64
_OPTIONS: Final = MappingProxyType(
    {
        "topic": "topics that are read, with commas between them; + and # stand for parts of names",
        "user": "user of the broker",
        "password": "password of the user",
        "ca": "file with the authority of the broker's certificate",
    }
)
#: The schemes of MQTT links that carry rows, by the name after `csv+` or `frames+`.
SCHEMES: Final = MappingProxyType(
    {
        name: LinkScheme(
            name=name,
            backend="mavstack.server.rows.mqtt:MqttLink",
            address=AddressKind.HOST,
            example=f"{name}://127.0.0.1:{port}?topic=bench/values",
            purpose="Reads messages of an MQTT broker.",
            default_port=port,
            options=_OPTIONS,
        )
        for name, port in (("mqtt", 1883), ("mqtts", 8883))
    }
)


class MqttChannel(Channel):
    """The broker."""

    def send_bytes(self, _data: Data) -> bool:
        """Send nothing: the link only receives."""
        return False

    def close_transport(self) -> None:
        """Do nothing: the link ends the session."""


class MqttLink(Link):
    """A link to a broker.

    Raises:
        LinkURLError: The URL has no topic, or an unknown option.
        MissingExtraError: paho-mqtt is not installed.
    """

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        topics = tuple(each.strip() for each in options.text("topic").split(",") if each.strip())
        if not 1 <= len(topics) <= MAX_TOPICS or not all(map(is_topic_filter, topics)):
            raise LinkURLError(f"{url.redacted}: the option topic must name topics such as bench/values")
        secure = url.scheme == "mqtts"
        user, password, authority = (options.text(name) for name in ("user", "password", "ca"))
        broker = Broker(url.host, url.port, secure, user, password, authority)
        self._session = Session(
            broker,
            subscriptions=topics,
            connected=self._connect,
            disconnected=self._disconnect,
            take=self._take,
        )
        self._channel: MqttChannel | None = None

    async def open_transport(self) -> None:
        """Connect with the broker, and read the topics."""
        await self._session.open()

    async def stop_transport(self) -> None:
        """Disconnect."""
        await self._session.close()

    def _connect(self) -> None:
        if self._channel is None and not self.closed:
            peer = f"{self.url.host}:{self.url.port}"
            self._channel = MqttChannel(f"{self.url.scheme} {peer}", peer, self.inbox.remove_channel)
            self.inbox.add_channel(self._channel)

    def _disconnect(self, reason: str) -> None:
        channel, self._channel = self._channel, None
        if channel is not None:
            channel.close(f"the broker is away: {reason}")

    def _take(self, message: Arrived) -> None:
        if message.discarded:
            logger.warning("%s: a message with %d bytes is discarded", message.topic, message.discarded)
        elif self._channel is not None and not self.closed:
            self._channel.last_received = now = time()
            self.inbox.deliver(self._channel, message.payload, now)


def is_topic_filter(text: str) -> bool:
    """Return whether a text is a filter of topics, in which + and # are whole parts and # the last one."""
    parts = text.split("/")
    return (
        0 < len(text) <= 1 << 10
        and all(part in {"+", "#"} or not {"+", "#", "\0"} & set(part) for part in parts)
        and "#" not in parts[:-1]
    )
