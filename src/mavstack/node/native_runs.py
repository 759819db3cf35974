"""The packets that the native input of a node took from the core, their channels, and their order."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links import Channel
    from mavstack.links.native_reading import NativeReading
    from mavstack.node.channel_state import ChannelState
    from mavstack.wire import Packet, Parser


@dataclass(frozen=True, slots=True)
class Attached:
    """A channel whose packets the core parses; without a reading its bytes are fed to the core.

    Attributes:
        parser: The parser that the core uses.
    """

    channel: Channel
    state: ChannelState
    reading: NativeReading | None
    parser: Parser


class Run(NamedTuple):
    """Consecutive packets of a channel.

    Attributes:
        packets: The packets that the engine handles, oldest first.
        listened: If they were kept, those that listeners take; some of them may be in `packets` too.
        is_kept: They were kept as latest packets already.
        is_checked: Those that listeners take need no check of the engine.
    """

    attached: Attached
    packets: list[Packet]
    listened: list[Packet]
    is_kept: bool
    is_checked: bool

    def outdated_bytes(self) -> bytes:
        """Return the bytes of packets that the channel must parse again: its key changed after they came."""
        if self.attached.parser is self.attached.state.parser:
            return b""
        others = set(map(id, self.listened))
        packets = [*self.listened, *(packet for packet in self.packets if id(packet) not in others)]
        return b"".join(packet.raw for packet in packets)


class Taken:
    """The handling of what was taken from the core.

    Attributes:
        calls: What is to be called, in order.
        afterwards: What is to be called when all of it was handled.
    """

    def __init__(self) -> None:
        self.calls: deque[Callable[[], None]] = deque()
        self.afterwards: deque[Callable[[], None]] = deque()
        self._is_under_way = False

    @property
    def is_handled(self) -> bool:
        """True if nothing is left, and nothing is being handled."""
        return not (self.calls or self.afterwards or self._is_under_way)

    def handle(self) -> None:
        """Handle everything; if a part of it calls this, the rest is handled after that part."""
        if self._is_under_way:
            return
        self._is_under_way = True
        try:
            while calls := self.calls or self.afterwards:
                calls.popleft()()
        finally:
            self._is_under_way = False

    def clear(self) -> None:
        """Drop what was not handled yet."""
        self.calls.clear()
        self.afterwards.clear()
