"""Raw packets as mavros_msgs/Mavlink, so that other programs can speak with the vehicle."""

from __future__ import annotations

from struct import pack
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.bridges.core.inbound import Inbound
    from mavstack.bridges.core.row import Values
    from mavstack.dialects import Message
    from mavstack.wire import Packet

_V1, _V2 = 0xFE, 0xFD
_HEADER_SIZES: Final = {_V1: 6, _V2: 10}
_CHECKSUM_SIZE: Final = 2
_SIGNATURE_SIZE: Final = 13
_SIGNED: Final = 1
_FRAMING_OK: Final = 1


def packet_values(packet: Packet) -> Values:
    """Return the values of mavros_msgs/Mavlink behind the header, for a packet."""
    raw = packet.raw
    magic = raw[0]
    size = _HEADER_SIZES[magic]
    length = raw[1]
    payload = raw[size : size + length]
    checksum = int.from_bytes(raw[size + length : size + length + _CHECKSUM_SIZE], "little")
    flags = (raw[2], raw[3]) if magic == _V2 else (0, 0)
    words = memoryview(payload.ljust(-(-length // 8) * 8, b"\0")).cast("Q")
    signature = raw[size + length + _CHECKSUM_SIZE :]
    return (
        _FRAMING_OK, magic, length, *flags, packet.sequence, packet.system, packet.component,
        packet.message_id, checksum, tuple(words), signature,
    )  # fmt: skip


def packet_bytes(fields: dict[str, Any]) -> bytes:
    """Return the bytes of the packet in mavros_msgs/Mavlink.

    Raises:
        InvalidArgumentError: They are not those of a packet.
    """
    magic, length = fields["magic"], fields["len"]
    words = fields["payload64"]
    if magic not in _HEADER_SIZES or length > len(words) * 8:
        raise InvalidArgumentError("the message does not hold a packet")
    payload = pack(f"<{len(words)}Q", *words)[:length]
    names = (fields["seq"], fields["sysid"], fields["compid"])
    number = fields["msgid"].to_bytes(4, "little")
    if magic == _V1:
        header = bytes((magic, length, *names, number[0]))
    else:
        header = bytes((magic, length, fields["incompat_flags"], fields["compat_flags"], *names)) + number[:3]
    checksum = fields["checksum"].to_bytes(_CHECKSUM_SIZE, "little")
    signed = magic == _V2 and fields["incompat_flags"] & _SIGNED
    signature: bytes = fields["signature"].ljust(_SIGNATURE_SIZE, b"\0") if signed else b""
    return bytes(header + payload + checksum + signature)


def packet_sink(fields: dict[str, Any], inbound: Inbound) -> Sequence[Message]:
    """Return the message of the packet in mavros_msgs/Mavlink; it is sent from the address of the bridge."""
    from mavstack.dialects import Dialect

    del inbound
    packets = Parser(Dialect.load("all")).feed(packet_bytes(fields))
    if not packets or packets[0].message is None:
        raise InvalidArgumentError("the message does not hold a packet")
    return (packets[0].message,)
