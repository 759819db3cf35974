"""The packets that the native input of a node took from the core, and the channels from which they came."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
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
