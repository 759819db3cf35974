"""A packet as a record of a log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.records import LogRecord

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.wire import Packet

_NOT_A_TIME: Final = np.datetime64("NaT", "us")


class PacketRecord(LogRecord):
    """A packet as a mapping from the field names of its message to values.

    Args:
        packet: A packet whose message is in the dialect.

    Attributes:
        packet: The packet.
    """

    def __init__(self, packet: Packet) -> None:
        self.packet = packet
        self.name = packet.name or ""

    @property
    def time(self) -> np.datetime64:
        """Recorded time in UTC, in microseconds; NaT if the packet has none."""
        time = self.packet.timestamp
        return _NOT_A_TIME if time is None or time >= 1 << 63 else np.datetime64(time, "us")

    @property
    def message(self) -> Message:
        """The typed message."""
        message: Message = self.packet.message
        return message

    @property
    def system(self) -> int:
        """System id of the sender."""
        return self.packet.system

    @property
    def component(self) -> int:
        """Component id of the sender."""
        return self.packet.component

    def __getitem__(self, field: str) -> object:
        names = list(self)
        if field not in names:
            raise KeyError(field)
        return getattr(self.message, self.message.__match_args__[names.index(field)])

    def __iter__(self) -> Iterator[str]:
        return (item.name for item in self.message.definition.fields)

    def __len__(self) -> int:
        return len(self.message.definition.fields)
