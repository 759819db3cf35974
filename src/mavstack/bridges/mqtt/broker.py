"""The broker of MQTT: its URL, and one session with it.

The library has a thread for each session, which connects again by itself. Its callbacks pass through a
`Handoff` into the event loop. `publish` never waits: messages that the network cannot take are dropped and
counted.
"""

from __future__ import annotations

import asyncio
import logging
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import unquote, urlsplit

from mavstack.bridges.core.plain_json import MAX_REQUEST
from mavstack.bridges.core.sink import MAX_ITEMS, Handoff
from mavstack.errors import InvalidArgumentError, LinkError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

logger = logging.getLogger("mavstack.bridges")
#: Seconds in which the broker must accept the first connection.
OPEN_TIMEOUT: Final = 5.0
#: Seconds between pings; the broker publishes the last will after 1.5 times this without a ping.
KEEP_ALIVE: Final = 10
#: Initial and maximum seconds between two attempts to reconnect.
_RETRIES: Final = (1, 30)
#: Seconds that a closing session waits for messages that are not yet acknowledged.
_CLOSE_TIMEOUT: Final = 1.0
_PORTS: Final = {"mqtt": 1883, "mqtts": 8883}
#: Maximum size in bytes of a message that the broker may send: the largest request, its topic and properties.
#: A broker discards larger ones (Maximum Packet Size of MQTT 5).
MAX_PACKET: Final = MAX_REQUEST + (256 << 10)
_RETAIN_ALL: Final = 0
_RETAIN_NOTHING: Final = 2
_MIN_QOS_WITH_ACK: Final = 1


@dataclass(frozen=True, slots=True)
class Broker:
    """The address of a broker.

    Attributes:
        host: The host.
        port: The port.
        tls: The connection is encrypted, and the certificate of the broker is checked.
        user: The user; empty: none.
        password: The password.
        authority: The file with the certificate of the authority for TLS; empty: those of the system.
    """

    host: str
    port: int
    tls: bool = False
    user: str = ""
    password: str = ""
    authority: str = ""

    @classmethod
    def parse(cls, url: str) -> Broker:
        """Return the broker of a URL: mqtt://host:1883, mqtts://user:password@host.

        Raises:
            InvalidArgumentError: It is not such a URL.
        """
        try:
            parts = urlsplit(url)
        except ValueError:  # such as a bracket without its end
            parts = urlsplit("")
        try:
            port = parts.port
        except ValueError:
            port = -1
        known = _PORTS.get(parts.scheme)
        if known is None or not parts.hostname or port == -1 or parts.path.strip("/") or parts.query:
            raise InvalidArgumentError(
                "a broker must be mqtt://HOST:PORT or mqtts://USER:PASSWORD@HOST:PORT, "
                f"got {parts._replace(netloc=parts.hostname or '').geturl()!r:.60}"
            )
        user, password = unquote(parts.username or ""), unquote(parts.password or "")
        return cls(parts.hostname, port or known, parts.scheme == "mqtts", user, password)

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"mqtt{'s' if self.tls else ''}://{host}:{self.port}"

    def __repr__(self) -> str:
        return f"Broker({self})"


@dataclass(frozen=True, slots=True)
class Arrived:
    """A message from the broker.

    Attributes:
        topic: The topic.
        payload: The bytes.
        retained: It is an old one that the broker kept.
        response_topic: Where the sender wants the answer; empty: nowhere.
        correlation: What the answer has to contain, so that the sender knows it.
        discarded: The size of a payload of more than `MAX_REQUEST` bytes, which was discarded; else 0.
    """

    topic: str
    payload: bytes = b""
    retained: bool = False
    response_topic: str = ""
    correlation: bytes = b""
    discarded: int = 0


class Session:
    """One connection with a broker, which lasts until it is closed.

    Args:
        broker: The broker.
        will: The topic that gets "offline", retained, when the session breaks; empty: none.
        subscriptions: The topics whose messages are taken.
        connected: Called in the event loop after each connection.
        disconnected: Called in the event loop with the reason when a connection is lost.
        take: Called in the event loop with each message.
        retained: The messages that the broker keeps are taken too.

    Raises:
        MissingExtraError: paho-mqtt is not installed.
    """

    def __init__(
        self,
        broker: Broker,
        will: str = "",
        subscriptions: Sequence[str] = (),
        *,
        connected: Callable[[], object] = lambda: None,
        disconnected: Callable[[str], object] = lambda reason: None,
        take: Callable[[Arrived], object] = lambda message: None,
        retained: bool = False,
    ) -> None:
        try:
            from paho.mqtt import client, enums
        except ImportError:
            raise MissingExtraError("the bridge to MQTT", "mqtt") from None
        #: The number of messages that could not be sent to the broker or queued for it.
        self.dropped = 0
        self._module: Any = client
        self._broker = broker
        self._will = will
        self._subscriptions = tuple(subscriptions)
        self._retain_handling = _RETAIN_ALL if retained else _RETAIN_NOTHING
        self._under_way = 0
        self._connected_callback, self._disconnected_callback = connected, disconnected
        self._client: Any = client.Client(enums.CallbackAPIVersion.VERSION2, protocol=client.MQTTv5)
        self._arrivals: Handoff[Arrived] | None = None
        self._take = take
        self._first: asyncio.Future[str] | None = None
        self._online = False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._prepare()

    def _prepare(self) -> None:
        client, broker = self._client, self._broker
        if broker.user:
            client.username_pw_set(broker.user, broker.password or None)
        if broker.tls:
            try:
                client.tls_set(broker.authority or None)
            except OSError as error:
                raise InvalidArgumentError(
                    f"reading the certificate {broker.authority} failed: {error.strerror or error}"
                ) from None
        if self._will:
            client.will_set(self._will, b"offline", qos=1, retain=True)
        client.reconnect_delay_set(*_RETRIES)
        client.max_queued_messages_set(MAX_ITEMS)
        client.on_connect = self._on_connect
        client.on_connect_fail = self._on_connect_fail
        client.on_disconnect = self._on_disconnect
        client.on_message = self._on_message
        client.on_publish = self._on_publish

    async def open(self, timeout: float = OPEN_TIMEOUT) -> None:  # noqa: ASYNC109
        """Connect, and stay connected.

        Args:
            timeout: Seconds in which the broker must accept the first connection.

        Raises:
            LinkError: The broker does not answer, or refuses.
        """
        self._loop = asyncio.get_running_loop()
        self._arrivals = Handoff(self._loop, self._take)
        self._first = self._loop.create_future()
        first_only = self._module.MQTT_CLEAN_START_FIRST_ONLY
        host, port = self._broker.host, self._broker.port
        properties = self._module.Properties(self._module.PacketTypes.CONNECT)
        properties.MaximumPacketSize = MAX_PACKET
        self._client.connect_async(host, port, KEEP_ALIVE, clean_start=first_only, properties=properties)
        self._client.loop_start()
        try:
            async with asyncio.timeout(timeout):
                reason = await self._first
        except TimeoutError:
            reason = "no answer"
        except asyncio.CancelledError:
            await self.close()
            raise
        if reason:
            await self.close()
            raise LinkError(
                f"connecting to the MQTT broker {self._broker} failed: {reason}; is it running, and does it "
                "accept this client?"
            )

    async def close(self) -> None:
        """Publish that the vehicle is offline, and disconnect. Idempotent."""
        loop, self._loop = self._loop, None
        if loop is not None:
            await loop.run_in_executor(None, self._end)

    def _end(self) -> None:
        if self._online and self._will:
            info = self._client.publish(self._will, b"offline", qos=1, retain=True)
            try:
                info.wait_for_publish(_CLOSE_TIMEOUT)
            except (ValueError, RuntimeError):
                logger.debug("the broker did not take the last message")
        self._client.disconnect()
        self._client.loop_stop()

    def publish(
        self, topic: str, payload: bytes, *, qos: int = 0, retain: bool = False, correlation: bytes = b""
    ) -> bool:
        """Publish a message without waiting; return False if it was dropped."""
        if self._under_way >= MAX_ITEMS:
            self.dropped += 1
            return False
        properties = None
        if correlation:
            properties = self._module.Properties(self._module.PacketTypes.PUBLISH)
            properties.CorrelationData = correlation
        try:
            info = self._client.publish(topic, payload, qos=qos, retain=retain, properties=properties)
        except ValueError as error:
            logger.debug("publishing %r failed: %s", topic, error)
            self.dropped += 1
            return False
        # Without a connection, a message with acknowledgement is sent later; one without acknowledgement is
        # lost.
        waits = qos >= _MIN_QOS_WITH_ACK and info.rc == self._module.MQTT_ERR_NO_CONN
        if info.rc != self._module.MQTT_ERR_SUCCESS and not waits:
            self.dropped += 1
            return False
        self._under_way += 1
        return True

    # Callbacks in the thread of the library

    def _on_connect(self, client: Any, _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:  # noqa: ANN401
        if reason.is_failure:
            self._call(partial(self._report, f"it refuses: {reason}"))
            return
        for topic in self._subscriptions:
            # QoS 0 delivers at most once, so that no command is carried out twice.
            options = self._module.SubscribeOptions(qos=0, retainHandling=self._retain_handling)
            client.subscribe(topic, options=options)
        self._call(self._go_online)

    def _on_connect_fail(self, _client: Any, _data: Any) -> None:  # noqa: ANN401
        self._call(partial(self._report, "nothing accepts connections there"))

    def _on_disconnect(self, _client: Any, _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:  # noqa: ANN401
        self._call(partial(self._go_offline, str(reason)))

    def _on_publish(self, *arguments: object) -> None:
        del arguments
        self._under_way = max(self._under_way - 1, 0)

    def _on_message(self, _client: Any, _data: Any, message: Any) -> None:  # noqa: ANN401
        properties = message.properties
        try:
            topic = message.topic
        except UnicodeDecodeError:
            return  # the broker does not check the topics of its clients
        payload = bytes(message.payload)
        discarded = len(payload) if len(payload) > MAX_REQUEST else 0
        arrived = Arrived(
            topic,
            b"" if discarded else payload,
            bool(message.retain),
            getattr(properties, "ResponseTopic", ""),
            bytes(getattr(properties, "CorrelationData", b"")),
            discarded,
        )
        if self._arrivals is not None:
            self._arrivals.put(arrived)

    def _call(self, function: Callable[[], object]) -> None:
        loop = self._loop
        if loop is not None and not loop.is_closed():
            loop.call_soon_threadsafe(function)

    # In the event loop

    def _report(self, reason: str) -> None:
        if self._first is not None and not self._first.done():
            self._first.set_result(reason)
        else:
            logger.debug("connecting to %s failed: %s", self._broker, reason)

    def _go_online(self) -> None:
        self._online, self._under_way = True, 0
        if self._first is not None and not self._first.done():
            self._first.set_result("")
        else:
            logger.info("connected with the MQTT broker %s again", self._broker)
        self._connected_callback()

    def _go_offline(self, reason: str) -> None:
        if self._online:
            self._online = False
            logger.warning("the MQTT broker %s is not connected any more: %s", self._broker, reason)
            self._disconnected_callback(reason)
