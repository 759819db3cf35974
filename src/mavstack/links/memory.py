"""Links within one process: `a, b = memory_pair()`, or any number of links with a common name.

    network = MemoryNetwork()
    ground, copter, plane = (network.link("memory://fleet") for _ in range(3))

Each other open link of the same name is a channel. The network is an object of the program, not a global
registry, so that two tests or two fleets are isolated from each other. A written chunk is received
immediately: the only queue is that of the receiver, and a chunk for which it has no room counts as dropped by
the sender.
"""

from __future__ import annotations

from itertools import count
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import LinkURLError
from mavstack.links.base import Link
from mavstack.links.channel import Channel, Data
from mavstack.links.options import Options
from mavstack.links.url import LinkURL, parse_url

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.inbox import Inbox


class MemoryNetwork:
    """A network of memory links, which connect to all links of the same name.

    Args:
        clock: Returns the time of received chunks, in Unix seconds.
    """

    def __init__(self, clock: Callable[[], float] = time) -> None:
        self.clock = clock
        self._open: dict[str, list[MemoryLink]] = {}
        self._numbers = count(1)

    def link(self, url: str = "memory://pair") -> MemoryLink:
        """Create a link that connects to all links of the same name when it is opened.

        Args:
            url: A memory URL, such as `memory://fleet?receive_queue=64k`.

        Returns:
            The link, not open yet.

        Raises:
            LinkURLError: The URL is not a memory URL, or has an unknown option.
        """
        parsed = parse_url(url)
        if parsed.scheme != "memory":
            raise LinkURLError(f"{parsed.redacted} is not a memory URL; for example: memory://fleet")
        options = Options(parsed)
        link = MemoryLink(parsed, options, self, f"{parsed.path}#{next(self._numbers)}")
        options.refuse_unknown()
        return link

    def connect_all(self, link: MemoryLink) -> None:
        """Connect the link to all other open links of its name."""
        others = self._open.setdefault(link.url.path, [])
        for other in others:
            link.connect(other)
        others.append(link)

    def remove(self, link: MemoryLink) -> None:
        """Remove a closed link."""
        others = self._open.get(link.url.path, [])
        if link in others:
            others.remove(link)


class MemoryChannel(Channel):
    """One of two connected channels; written bytes are received by the other one."""

    def __init__(self, name: str, inbox: Inbox, clock: Callable[[], float]) -> None:
        super().__init__(f"memory {name}", name, inbox.remove_channel)
        self.other: MemoryChannel | None = None
        self.inbox = inbox
        self._clock = clock

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        other = self.other
        return other is not None and other.receive(bytes(data))

    def receive(self, data: bytes) -> bool:
        """Receive a chunk, if the receive queue has room."""
        if self.inbox.full:
            return False
        self.inbox.put(self, data, self._clock())
        return True

    def close_transport(self) -> None:
        """Start closing the transport."""
        other, self.other = self.other, None
        if other is not None:
            other.close("closed by the peer")


class MemoryLink(Link):
    """A link to all other links of the same name in one network."""

    def __init__(self, url: LinkURL, options: Options, network: MemoryNetwork, name: str) -> None:
        super().__init__(url, options)
        self._network = network
        self._name = name

    def connect(self, other: MemoryLink) -> None:
        """Open a channel at both links."""
        local = MemoryChannel(other._name, self.inbox, self._network.clock)
        remote = MemoryChannel(self._name, other.inbox, self._network.clock)
        local.other, remote.other = remote, local
        self.inbox.add_channel(local)
        other.inbox.add_channel(remote)

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        self._network.connect_all(self)

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        self._network.remove(self)


def memory_pair(clock: Callable[[], float] = time) -> tuple[MemoryLink, MemoryLink]:
    """Create two links that connect to each other.

    Args:
        clock: Returns the time of received chunks, in Unix seconds.

    Returns:
        Both links, not open yet.
    """
    network = MemoryNetwork(clock)
    return network.link(), network.link()


def refuse_url(url: LinkURL, options: Options) -> Link:
    """Refuse a memory URL in `open_link`, because it does not name its network."""
    raise LinkURLError(
        f"{url.redacted} needs a network: create the link with MemoryNetwork().link({url.redacted!r})"
    )
