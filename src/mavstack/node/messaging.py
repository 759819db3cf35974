"""Sending and receiving of a node: subscriptions, listeners, events, messages.

The functions are methods of `Node`, which binds them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import Message
from mavstack.node.host import host_of
from mavstack.node.recording import Recording
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    from mavstack.node.dispatch import Listener
    from mavstack.node.node import Node
    from mavstack.node.subscription import Subscription
    from mavstack.services import Service
    from mavstack.wire import Packet

AnyMessage = TypeVar("AnyMessage", bound=Message)
AnyEvent = TypeVar("AnyEvent")


def stream(
    node: Node,
    *messages: type[AnyMessage],
    system: int = 0,
    component: int = 0,
    queue: int = DEFAULT_QUEUE,
    keep_all: bool = False,
) -> Subscription[AnyMessage]:
    """Subscribe to messages.

    Args:
        messages: Message classes; none: every message that the dialect defines.
        system: The system id of the sender; 0: any.
        component: The component id of the sender; 0: any.
        queue: Messages that are queued while the program does not read; then the oldest is dropped.
        keep_all: Queue without limit and drop nothing.

    Returns:
        An async iterator over the messages; close it, or use it as an async context manager.
    """
    return host_of(node).stream(messages, Address(system, component), queue=queue, keep_all=keep_all)


def packets(
    node: Node,
    *messages: type[Message],
    system: int = 0,
    component: int = 0,
    queue: int = DEFAULT_QUEUE,
    keep_all: bool = False,
) -> Subscription[Packet]:
    """Subscribe to packets: messages with their headers and raw bytes.

    Args:
        messages: Message classes; none: every packet, unknown message ids included.
        system: The system id of the sender; 0: any.
        component: The component id of the sender; 0: any.
        queue: Packets that are queued while the program does not read; then the oldest is dropped.
        keep_all: Queue without limit and drop nothing.

    Returns:
        An async iterator over the packets; close it, or use it as an async context manager.
    """
    return host_of(node).packet_dispatch.subscribe(
        messages, Address(system, component), _unchanged, queue=queue, keep_all=keep_all
    )


def add_listener(
    node: Node,
    kind: type[AnyMessage] | tuple[type[AnyMessage], ...],
    callback: Callable[[AnyMessage], None],
    *,
    system: int = 0,
    component: int = 0,
) -> Listener:
    """Call a function with each message of a class, as soon as it is received.

    Args:
        kind: A message class, or a tuple of them.
        callback: The function. It must return quickly, since it runs in the event loop.
        system: The system id of the sender; 0: any.
        component: The component id of the sender; 0: any.

    Returns:
        The listener; its `close()` ends the calls.
    """
    return host_of(node).add_listener(kind, callback, Address(system, component))


def add_packet_listener(
    node: Node,
    kind: type[Message] | tuple[type[Message], ...] | None,
    callback: Callable[[Packet], None],
    *,
    system: int = 0,
    component: int = 0,
) -> Listener:
    """Call a function with each packet of a message class, as soon as it is received.

    Args:
        kind: A message class, or a tuple of them; None: every packet, unknown message ids included.
        callback: The function. It must return quickly, since it runs in the event loop.
        system: The system id of the sender; 0: any.
        component: The component id of the sender; 0: any.

    Returns:
        The listener; its `close()` ends the calls.
    """
    kinds = () if kind is None else kind if isinstance(kind, tuple) else (kind,)
    return host_of(node).packet_dispatch.add(kinds, Address(system, component), callback)


def record(
    node: Node,
    path: str | PathLike[str],
    *,
    sent: bool = True,
    max_size: int | None = None,
    max_duration: float | None = None,
    keep: int | None = None,
) -> Recording:
    """Record the packets that the node receives and sends, without keys, passwords and signatures.

    Packets that are refused because of their signature are not recorded. With `max_size` or
    `max_duration` the files have a number: `flight-0001.tlog`, `flight-0002.tlog` …

    Args:
        path: Path of a new file: a tlog, or with the suffix `.pcap` a capture for Wireshark.
        sent: True records sent packets too, once for each channel.
        max_size: Bytes of a file before the next one begins; None: no limit.
        max_duration: Seconds of a file before the next one begins; None: no limit.
        keep: Number of numbered files that are kept, the newest ones; None keeps all.

    Returns:
        The recording: close it, or use it as an async context manager.

    Raises:
        InvalidArgumentError: A limit is not positive.
        LogError: The file exists, or cannot be created.
    """
    from mavstack.logs.recorder import Recorder  # imports numpy, which a node does not need otherwise

    recorder = Recorder(path, max_size=max_size, max_duration=max_duration, keep=keep)
    return Recording(host_of(node), recorder, sent=sent)


def events(
    node: Node, *kinds: type[AnyEvent], of: Service | None = None, queue: int = DEFAULT_QUEUE
) -> Subscription[AnyEvent]:
    """Subscribe to events of links and services.

    Args:
        kinds: Event classes; none: all.
        of: The service whose events are delivered; None: all links and services.
        queue: Events that are queued while the program does not read; then the oldest is dropped.

    Returns:
        An async iterator over the events; close it, or use it as an async context manager.
    """
    return host_of(node).events(*kinds, of=of, queue=queue)


def send(node: Node, message: Message, target: Address | None = None) -> None:
    """Send a message over the channels that lead to its target.

    Args:
        message: The message.
        target: The address to send to; None: the address in its target fields, or all components.

    Raises:
        InvalidStateError: The node is closed.
        EncodeError: The message cannot be encoded in the node's MAVLink version.
    """
    host_of(node).send(message, target)


def forward(node: Node, packet: Packet, target: Address | None = None) -> None:
    """Send a packet of another component unchanged to its target; see `Forwarding`.

    A SETUP_SIGNING is dropped, since it carries a signing key.

    Args:
        packet: The packet.
        target: The address to send to; None: the target of the packet. With the address of a vehicle a
            broadcast goes to this vehicle alone.

    Raises:
        InvalidStateError: The node is closed.
    """
    host_of(node).engine.forward(packet, host_of(node).now(), target)
    host_of(node).driver.step_soon()


def _unchanged(packet: Packet) -> Packet:
    return packet
