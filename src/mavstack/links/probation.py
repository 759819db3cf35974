"""The limit for a new peer of a UDP socket, whose address may be invented. Sans-IO.

A datagram shows an address, but not that its sender receives there. A peer that answered nothing gets at most
three times the bytes that it sent (as in QUIC, RFC 9000, 8.1), so that no sender can have a flood sent to a
victim. It answers by a packet for a system that packets were sent to it from, or by one of `ANSWERS`. Until
then streams and broadcast requests get at most half of what it may get; the rest is kept for heartbeats and
packets with a target, by which it learns which system it can answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.wire import Parser

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: Bytes that may be sent to a peer for each byte that it sent, until it has answered.
AMPLIFICATION: Final = 3
#: Messages without a target field that count as an answer.
ANSWERS: Final = frozenset({"PARAM_VALUE", "COMMAND_ACK", "TIMESYNC", "AUTOPILOT_VERSION"})


class Probation:
    """The limit for one peer, until it answers."""

    __slots__ = ("_allowance", "_for_others", "_parser", "_systems", "is_over")

    def __init__(self) -> None:
        #: Bytes that may be sent now: all, and the part of them for streams and broadcast requests.
        self._allowance = self._for_others = 0
        self._parser = Parser(common)
        self._systems: set[int] = set()
        #: True after the first answer of the peer: the limit has ended.
        self.is_over = False

    def received(self, data: bytes) -> None:
        """Record bytes from the peer.

        Args:
            data: Its datagrams.
        """
        self._allowance += AMPLIFICATION * len(data)
        self._for_others += AMPLIFICATION * len(data) // 2
        if self._systems:
            self.is_over = any(self._answers(packet) for packet in self._parser.feed(data))

    def may_send(self, data: bytes | bytearray | memoryview) -> bool:
        """Return whether a packet may be sent to the peer, and record it then.

        Args:
            data: The packet.

        Returns:
            False if the peer got as much as it may get.
        """
        if self.is_over:
            return True
        packets = Parser(common).feed(bytes(data))
        is_urgent = packets and all(packet.name == "HEARTBEAT" or _target(packet) for packet in packets)
        if len(data) > (self._allowance if is_urgent else min(self._allowance, self._for_others)):
            return False
        self._allowance -= len(data)
        self._for_others -= 0 if is_urgent else len(data)
        self._systems.update(packet.system for packet in packets)
        return True

    def _answers(self, packet: Packet) -> bool:
        return packet.name in ANSWERS or _target(packet) in self._systems


def _target(packet: Packet) -> int:
    target: int = getattr(packet.message, "target_system", 0)
    return target
