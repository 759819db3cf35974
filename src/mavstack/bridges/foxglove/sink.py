"""The Foxglove server as a sink. Its callbacks come on threads of the library, and pass into the event loop.

The server has a bounded queue for each client, and drops the oldest messages of a client that is too slow.
"""

from __future__ import annotations

import asyncio
import json
import logging
from functools import partial
from typing import TYPE_CHECKING, Any, Final, cast

import foxglove
from foxglove.websocket import Capability

from mavstack.bridges.core.sink import Handoff
from mavstack.bridges.core.types import codec_of
from mavstack.bridges.foxglove.channels import (
    ENCODING,
    TopicChannel,
    panel_channel,
    ros_channel,
    ros_schema,
)
from mavstack.bridges.foxglove.panels import PANELS
from mavstack.errors import CdrError, LinkError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
    from mavstack.bridges.core.topic import Topic
    from mavstack.bridges.foxglove.parameters import FoxgloveParameters, Value

logger = logging.getLogger("mavstack.bridges")
#: Seconds after which a service call is aborted; operations of the vehicle have shorter timeouts.
CALL_TIMEOUT: Final = 600.0
#: Seconds to wait until the event loop returns the values of parameters.
_VALUES_TIMEOUT: Final = 2.0
#: Maximum number of channels that clients advertise; further channels are ignored.
MAX_CLIENT_CHANNELS: Final = 1000
_JSON: Final = "json"


class FoxgloveSink:
    """A WebSocket server for Foxglove.

    Args:
        host: The address to listen on.
        port: The port; 0: the system chooses.
        control: Clients may publish and call services that act.
    """

    def __init__(self, host: str, port: int, *, control: bool = False) -> None:
        #: The parameters that clients see; set before `open`.
        self.parameters: FoxgloveParameters | None = None
        #: The number of messages from clients that could not be decoded.
        self.refused = 0
        self._host = host
        self._port = port
        self._control = control
        self._context = foxglove.Context()
        self._channels: dict[int, TopicChannel] = {}
        self._inlets: dict[str, Inlet] = {}
        self._services: list[Any] = []
        self._namespace = ""
        self._server: Any = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._calls: Handoff[Callable[[], object]] | None = None

    async def open(self) -> None:
        """Listen.

        Raises:
            LinkError: The port cannot be opened.
        """
        self._loop = loop = asyncio.get_running_loop()
        self._calls = Handoff(loop, lambda call: call())
        listener = _Listener(self)
        start = partial(
            foxglove.start_server,
            name="Mavstack",
            host=self._host,
            port=self._port,
            capabilities=self._capabilities(),
            server_listener=cast("Any", listener),
            supported_encodings=[ENCODING, _JSON],
            context=self._context,
        )
        try:
            self._server = await loop.run_in_executor(None, start)
        except Exception as error:
            raise LinkError(
                f"opening the Foxglove server on {self._host}:{self._port} failed: {error}; "
                "--port names another port"
            ) from error

    def _capabilities(self) -> list[Any]:
        wanted = [Capability.Parameters, Capability.Services]
        return [*wanted, Capability.ClientPublish] if self._control else wanted

    async def close(self) -> None:
        """Disconnect all clients. Idempotent."""
        server, self._server = self._server, None
        if self.parameters is not None:
            await self.parameters.close()
        if server is not None and self._loop is not None:
            await self._loop.run_in_executor(None, server.stop)
        for channel in self._channels.values():
            channel.close()
        self._channels.clear()

    @property
    def port(self) -> int:
        """The port of the server."""
        return int(self._server.port)

    @property
    def dropped(self) -> int:
        """The number of messages of clients that were dropped on their way into the event loop."""
        return 0 if self._calls is None else self._calls.dropped

    # Endpoints

    def add_node(self, namespace: str, _name: str) -> None:
        """Remember the namespace of the topics that follow."""
        self._namespace = namespace

    def add_topic(self, topic: Topic) -> None:
        """Announce a topic, and the channel for panels that is made of it."""
        number, channel = ros_channel(topic, self._context)
        self._channels[number] = channel
        panel = PANELS.get(topic.row.name)
        if panel is not None:
            number, channel = panel_channel(topic, panel, self._namespace, self._context)
            self._channels[number] = channel

    def add_inlet(self, inlet: Inlet) -> None:
        """Take the samples of clients on a topic."""
        self._inlets[inlet.name] = inlet

    def add_service(self, service: ServiceEndpoint) -> None:
        """Serve a service."""
        request, response = (
            foxglove.MessageSchema(encoding=ENCODING, schema=ros_schema(f"{service.type}_{part}"))
            for part in ("Request", "Response")
        )
        schema = foxglove.ServiceSchema(service.type, request=request, response=response)
        made = foxglove.Service(service.name, schema=schema, handler=partial(self._call, service))
        self._server.add_services([made])

    def publish_parameters(self, values: Mapping[str, Value]) -> None:
        """Send values to the clients that follow parameters."""
        if self._server is not None and values:
            self._server.publish_parameter_values(parameters_of(values))

    def _call(self, service: ServiceEndpoint, request: Any) -> bytes:
        """Answer a request; called in a thread of the library for each. An exception is the answer too."""
        if self._loop is None:
            raise RuntimeError("the bridge ended")
        future = asyncio.run_coroutine_threadsafe(service.call(bytes(request.payload)), self._loop)
        try:
            return future.result(CALL_TIMEOUT)
        except CdrError as error:
            raise ValueError(str(error)) from None

    # Called in threads of the library

    def hand_over(self, call: Callable[[], object]) -> None:
        """Call a function in the event loop; the oldest ones are dropped if it is too slow."""
        if self._calls is not None:
            self._calls.put(call)

    def known_values(self, names: list[str]) -> dict[str, Value]:
        """Return the known values of parameters from the event loop."""
        parameters, loop = self.parameters, self._loop
        if parameters is None or loop is None:
            return {}

        async def read() -> dict[str, Value]:
            parameters.download()
            return parameters.values(names)

        try:
            return asyncio.run_coroutine_threadsafe(read(), loop).result(_VALUES_TIMEOUT)
        except (TimeoutError, RuntimeError):
            return {}

    # Called in the event loop

    def subscribe(self, number: int) -> None:
        """Count the subscription of a client to a channel."""
        if (channel := self._channels.get(number)) is not None:
            channel.subscribe()

    def unsubscribe(self, number: int) -> None:
        """Count the end of a subscription."""
        if (channel := self._channels.get(number)) is not None:
            channel.unsubscribe()

    def receive(self, topic: str, encoding: str, data: bytes) -> None:
        """Pass a sample of a client to the vehicle; a bad one is counted."""
        inlet = self._inlets.get(topic)
        if inlet is None:
            self.refused += 1
            return
        if encoding == _JSON:
            try:
                data = codec_of(inlet.type).encode_fields(json.loads(data))
            except Exception as error:  # noqa: BLE001 (a client may send anything)
                self.refused += 1
                logger.debug("a sample of %s was refused: %s", topic, error)
                return
        if not inlet.receive(data):
            self.refused += 1

    def write_parameter(self, name: str, value: object) -> None:
        """Write a parameter for a client; it gets the value that the vehicle has then."""
        problem = "there are no parameters" if self.parameters is None else self.parameters.write(name, value)
        if problem:
            self.refused += 1
            logger.warning("%s", problem)
            if self._server is not None:
                self._server.publish_status(problem, foxglove.StatusLevel.Warning)


class _Listener:
    """The callbacks of the library; nothing raises."""

    def __init__(self, sink: FoxgloveSink) -> None:
        self._sink = sink
        self._advertised: dict[tuple[int, int], tuple[str, str]] = {}

    def on_subscribe(self, _client: Any, channel: Any) -> None:
        self._sink.hand_over(partial(self._sink.subscribe, channel.id))

    def on_unsubscribe(self, _client: Any, channel: Any) -> None:
        self._sink.hand_over(partial(self._sink.unsubscribe, channel.id))

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        if len(self._advertised) < MAX_CLIENT_CHANNELS:
            self._advertised[client.id, channel.id] = channel.topic, channel.encoding

    def on_client_unadvertise(self, client: Any, client_channel_id: int) -> None:
        self._advertised.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
        known = self._advertised.get((client.id, client_channel_id))
        if known is not None:
            self._sink.hand_over(partial(self._sink.receive, *known, bytes(data)))

    def on_get_parameters(
        self,
        _client: Any,
        param_names: list[str],
        _request_id: str | None = None,
    ) -> list[Any]:
        return parameters_of(self._sink.known_values(param_names))

    def on_set_parameters(
        self,
        _client: Any,
        parameters: list[Any],
        _request_id: str | None = None,
    ) -> list[Any]:
        for each in parameters:
            self._sink.hand_over(partial(self._sink.write_parameter, each.name, each.get_value()))
        return parameters_of(self._sink.known_values([each.name for each in parameters]))

    def on_parameters_subscribe(self, param_names: list[str]) -> None:
        del param_names

    def on_parameters_unsubscribe(self, param_names: list[str]) -> None:
        del param_names

    def on_connection_graph_subscribe(self) -> None:
        """Nothing: the capability is not offered."""

    def on_connection_graph_unsubscribe(self) -> None:
        """Nothing: the capability is not offered."""


def parameters_of(values: Mapping[str, Value]) -> list[Any]:
    """Return values as the library has them."""
    return [foxglove.Parameter(name, value=value) for name, value in values.items()]
