"""The choice between several vehicles that use one system id; see `chosen_senders`.

The functions about a node are methods of `Node`, which binds them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.links.scheme_table import find_scheme
from mavstack.node.host import host_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.links import Channel, Link
    from mavstack.node.host import NodeHost
    from mavstack.node.node import Node
    from mavstack.services import Address
    from mavstack.services.heartbeat import Conflict


def has_address_conflict(node: Node, address: Address) -> bool:
    """Return whether several senders use one address.

    Args:
        address: The address of a component.

    Returns:
        True while packets of that address contradict each other (boot time, type or unique id).
    """
    return host_of(node).discovery.has_conflict(address)


def id_conflict(node: Node, system: int) -> Conflict | None:
    """Return the vehicles that use one system id.

    Args:
        system: The system id.

    Returns:
        The senders and what tells them apart; None if no more than one vehicle uses the system id.
    """
    return host_of(node).discovery.vehicle_conflict(system)


def choose_sender(node: Node, system: int, channel: Channel | str | None) -> None:
    """Choose the vehicle to work with, where several use one system id.

    Its packets count only on that channel, and packets for it go over that channel alone, until another
    choice or until the channel closes.

    Args:
        system: The system id.
        channel: The channel, its name, or its remote address, such as "192.168.1.20:14550"; None: take
            the choice back.

    Raises:
        InvalidArgumentError: No open channel is named so, or the vehicles share the channel.
    """
    name = channel if channel is None or isinstance(channel, str) else channel.name
    before = host_of(node).engine.senders.chosen(system)
    if host_of(node).engine.senders.choose(system, name) != before:
        for address, remote in host_of(node).remotes.items():
            if address.system == system and host_of(node).is_open:
                remote.clear_cache()


async def check_sender(node: Node, system: int, operation: str = "acting on") -> None:
    """Wait until it is clear whether several vehicles use a system id, and refuse if they do.

    Every call that acts is refused in any case; this one comes before it does anything.

    Args:
        system: The system id.
        operation: The operation in the text of the error, with its preposition.

    Raises:
        SystemIdConflictError: Several vehicles use the system id, and none was chosen.
    """
    address = host_of(node).discovery.autopilot_of(system)
    if address is not None:
        await host_of(node).wait_until_examined(address, acting=True)
    node.refuse_conflict(system, operation)


def refuse_conflict(node: Node, system: int, operation: str = "acting on") -> None:
    """Refuse if several vehicles are known to use a system id.

    Args:
        system: The system id.
        operation: The operation in the text of the error, with its preposition.

    Raises:
        SystemIdConflictError: Several vehicles use the system id, and none was chosen.
    """
    address = host_of(node).discovery.conflicts.get(system)
    if address is not None and (error := host_of(node).refusal_of(address, operation)) is not None:
        raise error


def forget_sender(node: Node, system: int) -> None:
    """Forget the chosen vehicle of a system id, because it has another system id now.

    Args:
        system: The system id that it had.
    """
    discovery, senders = host_of(node).discovery, host_of(node).engine.senders
    name, address = senders.chosen(system), discovery.conflicts.get(system)
    senders.choose(system, None)
    if name is not None and address is not None:
        discovery.forget_channel(name, host_of(node).now(), address)
        host_of(node).wake(discovery)


def chosen_sender(node: Node, system: int) -> str | None:
    """Return the name of the channel that was chosen for a system id.

    Args:
        system: The system id.

    Returns:
        The name of the channel; None if none was chosen.
    """
    return host_of(node).engine.senders.chosen(system)


def follow_conflicts(host: NodeHost, links: Sequence[Link], channel: str | None) -> None:
    """Let the engine of a node refuse messages that act on one of several vehicles with one system id.

    Args:
        host: The host of the node.
        links: The links of the node, now and later.
        channel: The only channel whose packets count; None: all.
    """
    engine, discovery = host.engine, host.discovery
    engine.senders.limit_to(channel)
    engine.senders.systems = discovery.conflicts
    engine.senders.conflict_of = discovery.vehicle_conflict
    host.may_have_several_peers = lambda: len(links) > 1 or any(_listens(link.url.scheme) for link in links)
    engine.on_channel_closed = lambda name: discovery.forget_channel(name, host.now())


def _listens(name: str) -> bool:
    scheme = find_scheme(name)
    return scheme is not None and scheme.listens
