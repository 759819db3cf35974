"""ROS 2 by its own client library: inside a ROS installation, with any middleware.

The samples are our own CDR: `publish(bytes)` and raw subscriptions bypass the message objects of rclpy, which
cost more than everything else. A type is needed only for its support code, so a package that is not installed
costs its rows: one line names it.

rclpy spins in a thread of its own. Requests and samples pass through a `Handoff` into the event loop, and
samples of topics through an `Outbox` into another thread, since a reliable publisher may block.
"""

from __future__ import annotations

import asyncio
import logging
import os
import threading
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.sink import Handoff, Outbox
from mavstack.errors import CdrError, InvalidArgumentError

if TYPE_CHECKING:
    from concurrent.futures import Future

    from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
    from mavstack.bridges.core.qos import Qos
    from mavstack.bridges.core.topic import Topic

logger = logging.getLogger("mavstack.bridges")
#: Seconds between two checks whether a topic has subscribers.
MATCH_INTERVAL: Final = 0.25
#: Maximum number of requests that are answered at the same time.
MAX_REQUESTS: Final = 16
#: Seconds after which a request without an answer is aborted.
REQUEST_TIMEOUT: Final = 600.0
#: Seconds in which rclpy must shut down.
END_TIMEOUT: Final = 3.0
_THREADS: Final = MAX_REQUESTS + 2


class RclpySink:
    """The bus of a ROS 2 installation.

    Args:
        domain: The ROS_DOMAIN_ID.

    Raises:
        InvalidArgumentError: rclpy cannot be imported: the environment of ROS is not set up.
    """

    def __init__(self, domain: int) -> None:
        try:
            self._rclpy: Any = import_module("rclpy")
            self._executors: Any = import_module("rclpy.executors")
            self._groups: Any = import_module("rclpy.callback_groups")
            self._profiles: Any = import_module("rclpy.qos")
        except ImportError as error:
            raise InvalidArgumentError(
                f"--via rclpy needs a ROS installation ({error}): source its setup file first, or use "
                "--via zenoh, which needs none"
            ) from None
        self._domain = domain
        self._context: Any = None
        self._nodes: dict[str, Any] = {}
        self._publishers: list[_TopicPublisher] = []
        self._missing: set[str] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        self._thread: threading.Thread | None = None
        self._watch: asyncio.Task[None] | None = None

    @property
    def middleware(self) -> str:
        """The name of the middleware."""
        return os.environ.get("RMW_IMPLEMENTATION") or "its default middleware"

    async def open(self) -> None:
        """Start rclpy."""
        loop = asyncio.get_running_loop()
        self._loop = loop
        self._samples: Handoff[tuple[Inlet, bytes, dict[str, Any]]] = Handoff(loop, _receive_sample)
        self._outbox: Outbox[tuple[Any, bytes]] = Outbox(lambda item: item[0].publish(item[1]), name="rclpy")
        self._context = self._rclpy.Context()
        self._rclpy.init(context=self._context, domain_id=self._domain, args=[])
        self._executor = self._executors.MultiThreadedExecutor(_THREADS, context=self._context)
        self._thread = threading.Thread(target=self._spin, name="rclpy", daemon=True)
        self._thread.start()
        self._watch = loop.create_task(self._match())

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except Exception:
            logger.debug("rclpy ended", exc_info=True)

    async def close(self) -> None:
        """Stop rclpy. Idempotent."""
        context, self._context = self._context, None
        if context is None:
            return
        if self._watch is not None:
            self._watch.cancel()
        for task in self._tasks:
            task.cancel()
        self._outbox.close()
        await self._loop.run_in_executor(None, self._shut_down, context)

    def _shut_down(self, context: Any) -> None:  # noqa: ANN401 (a type of rclpy)
        self._executor.shutdown(timeout_sec=1.0)
        if self._thread is not None:
            self._thread.join(END_TIMEOUT)
        for node in self._nodes.values():
            node.destroy_node()
        self._rclpy.try_shutdown(context=context)

    # Endpoints

    def add_node(self, namespace: str, name: str) -> None:
        """Create a node."""
        node = self._rclpy.create_node(
            name,
            namespace=namespace,
            context=self._context,
            start_parameter_services=False,
            enable_rosout=False,
        )
        self._nodes[f"{namespace}/{name}"] = node
        self._executor.add_node(node)

    def add_topic(self, topic: Topic) -> None:
        """Create a publisher, and publish while it has subscribers."""
        made = self._type(topic.type)
        if made is None:
            return
        publisher = self._nodes[topic.node].create_publisher(made, topic.name, self._profile(topic.qos))
        self._publishers.append(_TopicPublisher(topic, publisher, self._outbox))

    def add_inlet(self, inlet: Inlet) -> None:
        """Create a raw subscription."""
        made = self._type(inlet.type)
        if made is None:
            return
        put = self._samples.put

        def receive(data: Any, info: dict[str, Any]) -> None:  # noqa: ANN401 (bytes, or a buffer)
            put((inlet, bytes(data), info))  # rclpy passes it to callbacks with two parameters

        self._nodes[inlet.node].create_subscription(
            made, inlet.name, receive, self._profile(inlet.qos), raw=True
        )

    def add_service(self, service: ServiceEndpoint) -> None:
        """Create a service."""
        made = self._type(service.type)
        if made is None:
            return
        group = self._groups.ReentrantCallbackGroup()
        self._nodes[service.node].create_service(
            made, service.name, lambda request, response: self._serve(service, request, response),
            callback_group=group,
        )  # fmt: skip

    def _serve(self, service: ServiceEndpoint, request: Any, response: Any) -> Any:  # noqa: ANN401
        """Answer a request; called in a thread of rclpy."""
        serialization: Any = import_module("rclpy.serialization")
        payload = serialization.serialize_message(request)
        future: Future[bytes] = asyncio.run_coroutine_threadsafe(service.call(bytes(payload)), self._loop)
        try:
            answer = future.result(REQUEST_TIMEOUT)
        except (CdrError, TimeoutError):
            return response
        return serialization.deserialize_message(answer, type(response))

    def _type(self, full_name: str) -> Any:  # noqa: ANN401
        """Return the class of an interface; None if its package is not installed, or lacks it."""
        package, kind, name = full_name.split("/")
        try:
            found: Any = import_module(f"{package}.{kind}")
            for part in _parts(name, kind):
                found = getattr(found, part)
        except (ImportError, AttributeError):
            self._report_missing(package)
            return None
        return found

    def _report_missing(self, package: str) -> None:
        if package not in self._missing:
            self._missing.add(package)
            logger.warning(
                "the ROS package %s is not installed, or is too old: its rows are left out "
                "(`mav bridge package %s FOLDER` writes its sources)",
                package,
                package,
            )

    def _profile(self, qos: Qos) -> Any:  # noqa: ANN401
        module = self._profiles
        reliability, durability = module.ReliabilityPolicy, module.DurabilityPolicy
        return module.QoSProfile(
            depth=qos.depth,
            reliability=reliability.RELIABLE if qos.reliable else reliability.BEST_EFFORT,
            durability=durability.TRANSIENT_LOCAL if qos.latched else durability.VOLATILE,
        )

    async def _match(self) -> None:
        while True:
            for publisher in self._publishers:
                publisher.update()
            await asyncio.sleep(MATCH_INTERVAL)

    @property
    def dropped(self) -> int:
        """The number of samples that were dropped because rclpy or the vehicle was too slow."""
        return self._samples.dropped + self._outbox.dropped


def _receive_sample(item: tuple[Inlet, bytes, dict[str, Any]]) -> None:
    inlet, payload, info = item
    publisher = info.get("publisher_gid")  # older versions of rclpy do not have it
    source = "" if publisher is None else publisher["data"].hex()
    inlet.receive(payload, source, info.get("source_timestamp", 0))


def _parts(name: str, kind: str) -> list[str]:
    """Return the path to a class: parts of actions are inside `Impl`."""
    action, _, part = name.partition("_")
    if kind != "action" or not part:
        return [name]
    return [action, "Impl", "FeedbackMessage" if part == "FeedbackMessage" else f"{part}Service"]


class _TopicPublisher:
    """A topic in rclpy, which is active while it has subscribers."""

    def __init__(self, topic: Topic, publisher: Any, outbox: Outbox[tuple[Any, bytes]]) -> None:  # noqa: ANN401
        self._topic = topic
        self._publisher = publisher
        self._outbox = outbox
        self._matching = False
        self.update()

    def update(self) -> None:
        """Follow the number of subscribers."""
        matching = self._topic.qos.latched or self._publisher.get_subscription_count() > 0
        if matching != self._matching:
            self._matching = matching
            if matching:
                self._topic.add_receiver(self._receive)
            else:
                self._topic.remove_receiver(self._receive)

    def _receive(self, payload: bytes, _stamp: int) -> None:
        self._outbox.put((self._publisher, payload))
