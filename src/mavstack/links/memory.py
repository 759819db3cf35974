"""Links within one process: `a, b = memory_pair()`, or any number of links that meet under a name.

    network = MemoryNetwork()
    ground, copter, plane = (network.link("memory://field") for _ in range(3))

Every other open link of the same name is a channel. The network is an object that the program owns, not a
hidden register: two tests, or two fleets, cannot hear each other by accident. A write is delivered at
once; the receiver's bounded queue is the only one, and a chunk it has no room for counts as dropped by the
sender.
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
    """Where memory links find each other; `clock` tells the time of what is received."""

    def __init__(self, clock: Callable[[], float] = time) -> None:
        self.clock = clock
        self._open: dict[str, list[MemoryLink]] = {}
        self._numbers = count(1)

    def link(self, url: str = "memory://pair") -> MemoryLink:
        """A new link that meets all others of the same name once it is opened."""
        parsed = parse_url(url)
        if parsed.scheme != "memory":
            raise LinkURLError(f"{parsed} is not a memory link; a right one is memory://fleet")
        options = Options(parsed)
        link = MemoryLink(parsed, options, self, f"{parsed.path}#{next(self._numbers)}")
        options.finish()
        return link

    def join(self, link: MemoryLink) -> None:
        """Make a channel between the link and each other one."""
        others = self._open.setdefault(link.url.path, [])
        for other in others:
            link.meet(other)
        others.append(link)

    def leave(self, link: MemoryLink) -> None:
        """Forget the link."""
        others = self._open.get(link.url.path, [])
        if link in others:
            others.remove(link)


class MemoryChannel(Channel):
    """One end of a pair; what is written here is received by the other end."""

    def __init__(self, name: str, inbox: Inbox, clock: Callable[[], float]) -> None:
        super().__init__(f"memory {name}", name, inbox.closed)
        self.other: MemoryChannel | None = None
        self._inbox = inbox
        self._clock = clock

    def _send(self, data: Data) -> bool:
        other = self.other
        return other is not None and other.receive(bytes(data))

    def receive(self, data: bytes) -> bool:
        """Take a chunk from the other end, if there is room."""
        if self._inbox.full:
            return False
        self._inbox.put(self, data, self._clock())
        return True

    def _shut(self) -> None:
        other, self.other = self.other, None
        if other is not None:
            other.close("closed by the peer")


class MemoryLink(Link):
    """A link to all other links of the same name on one network."""

    def __init__(self, url: LinkURL, options: Options, network: MemoryNetwork, name: str) -> None:
        super().__init__(url, options)
        self._network = network
        self._name = name

    def meet(self, other: MemoryLink) -> None:
        """Make a channel on each side."""
        mine = MemoryChannel(other._name, self._inbox, self._network.clock)
        theirs = MemoryChannel(self._name, other._inbox, self._network.clock)
        mine.other, theirs.other = theirs, mine
        self._inbox.opened(mine)
        other._inbox.opened(theirs)

    async def _open(self) -> None:
        self._network.join(self)

    async def _stop(self) -> None:
        self._network.leave(self)


def memory_pair(clock: Callable[[], float] = time) -> tuple[MemoryLink, MemoryLink]:
    """Two links that are each other's only peer once both are open."""
    network = MemoryNetwork(clock)
    return network.link(), network.link()


def refuse(url: LinkURL, options: Options) -> Link:
    """The opener of memory URLs: which network is meant cannot be told from a URL alone."""
    raise LinkURLError(f"{url} needs to know its network: open it by MemoryNetwork().link({str(url)!r})")
