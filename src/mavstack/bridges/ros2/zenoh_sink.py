"""ROS 2 over Zenoh: the endpoints of vehicles as those of a node with rmw_zenoh, without ROS.

The session is a client of a Zenoh router, as ROS 2 has one (`ros2 run rmw_zenoh_cpp rmw_zenohd`). Callbacks
of Zenoh come on its own threads, and pass through a `Handoff` into the event loop. Samples are put with
`DROP`, as rmw_zenoh puts them: it never blocks, so that a subscriber that stops reading delays no other one.
Reliable samples have a higher priority, and thus separate queues.
"""

from __future__ import annotations

import asyncio
import logging
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.qos import SERVICES
from mavstack.bridges.core.sink import Handoff
from mavstack.bridges.core.zenoh_session import (
    RouterReports,
    SessionOptions,
    close_session,
    direct,
    open_session,
    zenoh_module,
)
from mavstack.bridges.ros2.put_queue import PutQueue
from mavstack.bridges.ros2.zenoh_keys import (
    PUBLISHER,
    ROOT,
    SERVER,
    SUBSCRIPTION,
    GraphEntity,
    attachment_of,
    endpoint_token,
    gid_of,
    key_of,
    node_token,
    parse_attachment,
    parse_token,
)
from mavstack.errors import CdrError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
    from mavstack.bridges.core.topic import Topic

logger = logging.getLogger("mavstack.bridges")
#: Maximum number of requests that are answered at the same time; further ones wait in the `Handoff` queue.
MAX_REQUESTS: Final = 64
#: Seconds in which the answers to a query of the ROS graph must arrive.
GRAPH_TIMEOUT: Final = 2.0


class ZenohSink:
    """The bus of ROS 2 with rmw_zenoh.

    Args:
        domain: The ROS_DOMAIN_ID.
        routers: The endpoints of Zenoh routers, such as "tcp/127.0.0.1:7447".
        mode: "client" of a router, or "peer".
    """

    def __init__(self, domain: int, routers: Sequence[str], *, mode: str = "client") -> None:
        self._zenoh = zenoh_module("ROS 2 over Zenoh", "ros2")
        self._domain = domain
        self._options = SessionOptions(tuple(routers), mode)
        self._session: Any = None
        self._session_id = ""
        self._numbers = 0
        self._node_tokens: dict[str, str] = {}
        self._kept: list[Any] = []  # a declaration ends when its object is deleted
        self._publishers: list[_TopicPublisher] = []
        self._tasks: set[asyncio.Task[None]] = set()
        self._slots = asyncio.Semaphore(MAX_REQUESTS)

    async def open(self) -> None:
        """Connect to the router.

        Raises:
            LinkError: No router answers.
        """
        loop = asyncio.get_running_loop()
        self._samples: Handoff[tuple[Inlet, bytes, bytes]] = Handoff(loop, _receive_sample)
        self._requests: Handoff[tuple[ServiceEndpoint, str, Any]] = Handoff(loop, self._on_request)
        self._matches: Handoff[tuple[_TopicPublisher, bool]] = Handoff(loop, _set_matching)
        self._outgoing = PutQueue(loop.call_soon)
        self._session = await open_session(self._zenoh, self._options)
        self._reports = RouterReports(self._zenoh, self._session, self._options.routers)
        self._session_id = str(self._session.info.zid())

    async def close(self) -> None:
        """Disconnect. Idempotent."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        session, self._session = self._session, None
        if session is not None:
            self._outgoing.clear()
            self._reports.end()
        self._kept.clear()
        if session is not None:
            await close_session(session)

    # Endpoints

    def add_node(self, namespace: str, name: str) -> None:
        """Announce a node."""
        token = node_token(self._domain, self._session_id, self._next_number(), namespace, name)
        self._node_tokens[f"{namespace}/{name}"] = token
        self._kept.append(self._session.liveliness().declare_token(token))

    def add_topic(self, topic: Topic) -> None:
        """Announce a topic, and publish it while it has subscribers."""
        token = self._declare(topic.node, PUBLISHER, topic.name, topic.type, topic.qos)
        publisher = _TopicPublisher(topic, gid_of(token), self._outgoing)
        key = key_of(self._domain, topic.name, topic.type)
        zenoh, reliable = self._zenoh, topic.qos.reliable
        options = {
            "congestion_control": zenoh.CongestionControl.DROP,
            "reliability": zenoh.Reliability.RELIABLE if reliable else zenoh.Reliability.BEST_EFFORT,
            # A queue that streams of sensors do not fill, here and in the router.
            "priority": zenoh.Priority.DATA_HIGH if reliable else zenoh.Priority.DATA,
        }
        self._publishers.append(publisher)
        if topic.qos.latched:
            declared = zenoh.ext.declare_advanced_publisher(
                self._session,
                key,
                cache=zenoh.ext.CacheConfig(topic.qos.depth),
                publisher_detection=True,
                **options,
            )
            publisher.start(declared)
            publisher.set_matching(matching=True)
            return
        # This session has no subscribers to it; looking for local ones costs time for each sample.
        remote = zenoh.Locality.REMOTE
        declared = self._session.declare_publisher(key, allowed_destination=remote, **options)
        publisher.start(declared)
        put = self._matches.put
        listener = declared.declare_matching_listener(
            direct(self._zenoh, lambda status: put((publisher, status.matching)))
        )
        self._kept += [declared, listener]
        publisher.set_matching(matching=declared.matching_status.matching)

    def add_inlet(self, inlet: Inlet) -> None:
        """Subscribe to a topic for the vehicle."""
        self._declare(inlet.node, SUBSCRIPTION, inlet.name, inlet.type, inlet.qos)
        key = key_of(self._domain, inlet.name, inlet.type)
        put = self._samples.put

        def receive(sample: Any) -> None:  # noqa: ANN401 (a type of Zenoh)
            attachment = sample.attachment
            put((inlet, bytes(sample.payload), b"" if attachment is None else bytes(attachment)))

        self._kept.append(self._session.declare_subscriber(key, direct(self._zenoh, receive)))

    def add_service(self, service: ServiceEndpoint) -> None:
        """Serve a service."""
        self._declare(service.node, SERVER, service.name, service.type, SERVICES)
        key = key_of(self._domain, service.name, service.type)
        put = self._requests.put

        def receive(query: Any) -> None:  # noqa: ANN401 (a type of Zenoh)
            put((service, key, query))

        self._kept.append(self._session.declare_queryable(key, direct(self._zenoh, receive), complete=True))

    def _declare(self, node: str, kind: str, name: str, type_name: str, qos: Any) -> str:  # noqa: ANN401
        token = endpoint_token(self._node_tokens[node], self._next_number(), kind, name, type_name, qos=qos)
        self._kept.append(self._session.liveliness().declare_token(token))
        return token

    def _next_number(self) -> int:
        self._numbers += 1
        return self._numbers

    # Requests

    def _on_request(self, item: tuple[ServiceEndpoint, str, Any]) -> None:
        task = asyncio.get_running_loop().create_task(self._answer(*item))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _answer(self, service: ServiceEndpoint, key: str, query: Any) -> None:  # noqa: ANN401
        async with self._slots:
            with query, suppress(self._zenoh.ZError):
                payload = b"" if query.payload is None else bytes(query.payload)
                attachment = query.attachment
                try:
                    response = await service.call(payload)
                except CdrError as error:
                    query.reply_err(str(error).encode())
                    return
                # The client finds its request by the attachment, which must return unchanged.
                query.reply(key, response, attachment=None if attachment is None else bytes(attachment))

    # The graph

    async def graph(self) -> list[GraphEntity]:
        """Return all nodes and endpoints of the domain."""
        return await asyncio.get_running_loop().run_in_executor(None, self._graph)

    def _graph(self) -> list[GraphEntity]:
        replies = self._session.liveliness().get(f"{ROOT}/{self._domain}/**", timeout=GRAPH_TIMEOUT)
        keys = (str(reply.ok.key_expr) for reply in replies if reply.ok is not None)
        return [entity for key in keys if (entity := parse_token(key)) is not None]

    @property
    def dropped(self) -> int:
        """The number of samples and requests that were dropped on their way into the event loop."""
        return self._samples.dropped + self._requests.dropped


class _TopicPublisher:
    """A topic on Zenoh: its declared publisher, and the receiver of its samples."""

    def __init__(self, topic: Topic, gid: bytes, outgoing: PutQueue) -> None:
        self._topic = topic
        self._gid = gid
        self._outgoing = outgoing
        self._sequence = 0
        self._matching = False
        self._put: Callable[[bytes, bytes], None] | None = None

    def start(self, publisher: Any) -> None:  # noqa: ANN401 (a type of Zenoh)
        put = publisher.put
        self._put = lambda payload, attachment: put(payload, attachment=attachment)

    def set_matching(self, *, matching: bool) -> None:
        """Publish while there are subscribers."""
        if matching == self._matching:
            return
        self._matching = matching
        if matching:
            self._topic.add_receiver(self._receive)
        else:
            self._topic.remove_receiver(self._receive)

    def _receive(self, payload: bytes, stamp: int) -> None:
        self._sequence += 1
        if self._put is not None:
            attachment = attachment_of(self._sequence, stamp or time.time_ns(), self._gid)
            self._outgoing.add(self._put, payload, attachment)


def _receive_sample(item: tuple[Inlet, bytes, bytes]) -> None:
    inlet, payload, attachment = item
    _, sent, gid = parse_attachment(attachment) or (0, 0, b"")
    inlet.receive(payload, gid.hex(), sent)


def _set_matching(item: tuple[_TopicPublisher, bool]) -> None:
    publisher, matching = item
    publisher.set_matching(matching=matching)
